// SPDX-License-Identifier: BSD-3-Clause
// Finds links and builds maps like MapMerger: each build continues from the graph of the previous one.
#pragma once

#include <utility>

#include "map_server/merging/link_finder.h"
#include "map_server/merging/map_builder.h"

namespace rumi::testing {

class MapMaker {
 public:
  explicit MapMaker(const map_server::MapBuilderOptions& options = {}) : finder_(options.links), builder_(options) {}

  void find(const map_server::BuildInput& input) { graph_ = finder_.find(std::move(graph_), input); }
  map_server::BuiltMap build(const map_server::BuildInput& input) {
    find(input);
    map_server::BuiltMap built = builder_.build(std::move(graph_), input);
    graph_ = built.graph;
    return built;
  }
  const map_server::LinkGraph& graph() const { return graph_; }

 private:
  map_server::LinkFinder finder_;
  const map_server::MapBuilder builder_;
  map_server::LinkGraph graph_;
};

}  // namespace rumi::testing
