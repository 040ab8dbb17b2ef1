// SPDX-License-Identifier: BSD-3-Clause
#include "fuzz/target.h"

#include <spdlog/spdlog.h>

namespace rumi::fuzz {
namespace {

std::vector<Target>& registered() {
  static std::vector<Target> all;
  return all;
}

}  // namespace

const std::vector<Target>& targets() { return registered(); }

Registered::Registered(Target target) {
  spdlog::set_level(spdlog::level::off);  // a line for each broken message is what makes it slow
  registered().push_back(std::move(target));
}

}  // namespace rumi::fuzz
