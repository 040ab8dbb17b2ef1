// SPDX-License-Identifier: BSD-3-Clause
// Consensus by sampling (RANSAC; Fischler and Bolles, CACM 1981) for models that three elements determine.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <random>
#include <type_traits>
#include <utility>
#include <vector>

namespace rumi {

struct SamplingOptions {
  int samples = 500;                   // samples drawn, at most
  double miss_probability = 0;         // the search ends once the probability that no sample was right is so low; 0: it
                                       // draws all
  std::mt19937::result_type seed = 0;  // fixed, so that the answer is always the same
};

// Returns how many samples are needed so that one is right with probability 1 - miss_probability, if `share` of the
// elements are right.
inline int samples_needed(double share, double miss_probability) {
  if (miss_probability <= 0) return std::numeric_limits<int>::max();
  const double right = std::min(share * share * share, 1 - 1e-9);
  return static_cast<int>(std::min(1e9, std::ceil(std::log(miss_probability) / std::log1p(-right))));
}

template <class Model>
struct Consensus {
  Model model;
  std::vector<int> members;  // elements that agree with the model
};

// Searches the elements 0 ... count - 1. `propose` takes the three elements of a sample and returns a std::optional of
// a model; `agreeing` takes a model and returns the elements that agree with it. Returns nullopt if no model was
// proposed with which any element agrees.
template <class Propose, class Agreeing>
auto find_consensus_of_three(size_t count, const SamplingOptions& options, Propose propose, Agreeing agreeing) {
  using Model = typename std::invoke_result_t<Propose, std::array<int, 3>>::value_type;
  std::optional<Consensus<Model>> best;
  if (count < 3) return best;
  std::mt19937 rng(options.seed);
  int samples = options.samples;
  for (int i = 0; i < samples; ++i) {
    const std::array<int, 3> draw{static_cast<int>(rng() % count), static_cast<int>(rng() % count),
                                  static_cast<int>(rng() % count)};
    if (draw[0] == draw[1] || draw[0] == draw[2] || draw[1] == draw[2]) continue;
    const std::optional<Model> model = propose(draw);
    if (!model) continue;
    std::vector<int> members = agreeing(*model);
    if (members.size() <= (best ? best->members.size() : 0)) continue;
    best = Consensus<Model>{*model, std::move(members)};
    samples = std::min(samples, samples_needed(static_cast<double>(best->members.size()) / static_cast<double>(count),
                                               options.miss_probability));
  }
  return best;
}

}  // namespace rumi
