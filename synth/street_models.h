// SPDX-License-Identifier: BSD-3-Clause
// The pictures and models of a street's things. Few pictures serve many things, in different colours.
#pragma once

#include <vector>

#include "synth/street_mesh.h"
#include "synth/street_pictures.h"

namespace rumi::synth {

struct CarModel {
  Model model;
  double length_m;
};

// A person is put together for each moment, because the legs move.
struct PersonPictures {
  std::vector<TextureAtlas::Patch> cloth;
  TextureAtlas::Patch skin;
};

class StreetModels {
 public:
  StreetModels(uint64_t seed, TextureAtlas* atlas);

  TextureAtlas::Patch asphalt, paving, lawn;                                            // whole layers
  std::vector<TextureAtlas::Patch> walls, roofs, leaves, hedges, fences, signs;         // leaves and fences have holes
  std::vector<TextureAtlas::Patch> markings, manholes, tar, bark, metal, remote_walls;  // up to tar with holes
  std::vector<CarModel> cars;
  Model lorry;               // its back is at the origin; its front is kLorry_m farther along x
  std::vector<Model> trees;  // of 1 m height
  PersonPictures person;

  static constexpr double kLorry_m = 8.5, kLorryWidth_m = 2.5, kLorryHeight_m = 3.7;

 private:
  void paint_all(uint64_t seed, TextureAtlas* atlas);
  void build_cars(uint64_t seed, TextureAtlas* atlas);
  void build_lorry(uint64_t seed, TextureAtlas* atlas);
  void build_trees(uint64_t seed);
};

// Returns a person of that height, in the colours of `number`, in the middle of a step at phase 0 and 1.
Model person(const PersonPictures& pictures, double height_m, double phase, uint64_t number);

// Returns a value of the list that the number chooses.
template <class T>
const T& pick(const std::vector<T>& list, uint64_t number) {
  return list[(number * 2654435761u >> 7) % list.size()];
}

}  // namespace rumi::synth
