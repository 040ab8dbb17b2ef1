// SPDX-License-Identifier: BSD-3-Clause
// Divides the views of a map into pieces that can be adjusted one after another.
#pragma once

#include <vector>

#include "map_server/model/map_model.h"

namespace rumi::map_server {

// Returns each of these views once, in pieces of at most `most` views; the first piece has at most `first`. A piece
// grows by the view that shares most points with it, and ends when no remaining view shares any. Another `first` shifts
// the borders between the pieces.
std::vector<std::vector<int>> covisible_pieces(const MapModel& model, const std::vector<int>& views, int most,
                                               int first);

}  // namespace rumi::map_server
