// SPDX-License-Identifier: BSD-3-Clause
// Measures one adjustment of a whole map: loads a map.db, searches its submaps for links and builds the map from them,
// as map_server does if it has only the submaps.
#include <fmt/core.h>

#include <CLI/CLI.hpp>

#include "base/this_process/cpu_clock.h"
#include "map_server/options.h"
#include "map_server/store/map_store.h"

int main(int argc, char** argv) {
  CLI::App app{"CPU time of an adjustment of a stored map"};
  std::string file;
  app.add_option("MAP.db", file)->required()->check(CLI::ExistingFile);
  CLI11_PARSE(app, argc, argv);
  try {
    rumi::map_server::MapStore store = rumi::map_server::MapStore::copy_in_memory(file).value();
    const rumi::map_server::Atlas atlas = store.load().value();
    rumi::map_server::BuildInput input;
    for (const auto& [key, owner] : atlas.submaps()) input.submaps[key] = &owner.submap;
    const rumi::map_server::MapBuilderOptions options = rumi::map_server::MapServerOptions().merge.builder;
    const double start_s = rumi::thread_cpu_s();
    rumi::map_server::LinkGraph graph = rumi::map_server::LinkFinder(options.links).find({}, input);
    const double linked_s = rumi::thread_cpu_s();
    const rumi::map_server::MapBuildReport report =
        rumi::map_server::MapBuilder(options).build(std::move(graph), input).report;
    fmt::print("{} submaps, {} images, {} points, {} observations ({} by association), rmse {:.4f} sigma\n",
               report.members, report.views, report.points, report.observations, report.observed, report.rmse);
    fmt::print("links {:.2f}, adjustment {:.2f} CPU s\n", linked_s - start_s, rumi::thread_cpu_s() - linked_s);
  } catch (const std::exception& e) {
    fmt::print(stderr, "adjust_bench: {}\n", e.what());
    return 1;
  }
}
