// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/model/covisible_pieces.h"

#include <algorithm>
#include <queue>
#include <utility>

namespace rumi::map_server {
namespace {

class Divider {
 public:
  Divider(const MapModel& model, const std::vector<int>& views)
      : model_(model), left_(model.views.size(), 0), in_piece_(model.points.size(), 0) {
    for (int view : views) left_[view] = 1;
  }

  bool is_left(int view) const { return left_[view]; }

  std::vector<int> grow(int seed, int most) {
    std::vector<int> piece;
    std::vector<int> shared(model_.views.size(), 0);
    std::priority_queue<std::pair<int, int>> best;  // points in common, -view; outdated entries are skipped
    ++number_;
    best.emplace(0, -seed);
    while (!best.empty() && static_cast<int>(piece.size()) < most) {
      const auto [points, negative] = best.top();
      best.pop();
      if (!left_[-negative] || points != shared[-negative]) continue;
      take(-negative, &piece, &shared, &best);
    }
    std::sort(piece.begin(), piece.end());
    return piece;
  }

 private:
  void take(int view, std::vector<int>* piece, std::vector<int>* shared,
            std::priority_queue<std::pair<int, int>>* best) {
    left_[view] = 0;
    piece->push_back(view);
    std::vector<int> met;
    for (int point : model_.views[view].points) {
      if (point == kNone || std::exchange(in_piece_[point], number_) == number_) continue;
      for (const MapModel::Observation& o : model_.points[point].observations)
        if (left_[o.view]) {
          ++(*shared)[o.view];
          met.push_back(o.view);
        }
    }
    std::sort(met.begin(), met.end());
    met.erase(std::unique(met.begin(), met.end()), met.end());
    for (int other : met) best->emplace((*shared)[other], -other);
  }

  const MapModel& model_;
  std::vector<char> left_;
  std::vector<int> in_piece_;  // by point: the number of the last piece that sees it
  int number_ = 0;
};

}  // namespace

std::vector<std::vector<int>> covisible_pieces(const MapModel& model, const std::vector<int>& views, int most,
                                               int first) {
  Divider divider(model, views);
  std::vector<std::vector<int>> pieces;
  for (int view : views)
    if (divider.is_left(view)) pieces.push_back(divider.grow(view, pieces.empty() ? first : most));
  return pieces;
}

}  // namespace rumi::map_server
