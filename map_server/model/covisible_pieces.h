// SPDX-License-Identifier: BSD-3-Clause
// The views of a map in pieces that can be adjusted one by one.
#pragma once

#include <vector>

#include "map_server/model/map_model.h"

namespace rumi::map_server {

// Each of these views once, in pieces of at most `most`, the first one of at most `first`: a piece grows by the view
// that shares most points with it, and ends where nothing does. With another `first` they meet elsewhere.
std::vector<std::vector<int>> covisible_pieces(const MapModel& model, const std::vector<int>& views, int most,
                                               int first);

}  // namespace rumi::map_server
