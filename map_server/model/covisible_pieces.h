// SPDX-License-Identifier: BSD-3-Clause
// Divides the views of a map into pieces that can be adjusted one by one.
#pragma once

#include <vector>

#include "map_server/model/map_model.h"

namespace rumi::map_server {

// Returns each of these views once, in pieces of at most `most` views; the first piece has at most `first`. A piece
// grows by the view that shares most points with it, and ends when no view shares any. Another `first` moves the
// borders.
std::vector<std::vector<int>> covisible_pieces(const MapModel& model, const std::vector<int>& views, int most,
                                               int first);

}  // namespace rumi::map_server
