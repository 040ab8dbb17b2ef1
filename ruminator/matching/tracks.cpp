// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/matching/tracks.h"

#include <algorithm>
#include <numeric>

namespace rumi::ruminator {
namespace {

bool share_an_image(const Track& a, const Track& b) {
  auto i = a.begin();
  for (auto j = b.begin(); i != a.end() && j != b.end();) {
    if (i->first == j->first) return true;
    i->first < j->first ? ++i : ++j;
  }
  return false;
}

}  // namespace

std::vector<Track> join_tracks(const std::vector<WindowImage>& images, const std::vector<ImagePair>& pairs) {
  std::vector<int> offset{0};
  for (const WindowImage& image : images) offset.push_back(offset.back() + static_cast<int>(image.keypoints.size()));
  std::vector<int> track_of(offset.back());
  std::iota(track_of.begin(), track_of.end(), 0);
  std::vector<Track> tracks(offset.back());
  for (size_t image = 0; image < images.size(); ++image)
    for (int k = offset[image]; k < offset[image + 1]; ++k)
      tracks[k].emplace_back(static_cast<int>(image), k - offset[image]);

  std::vector<const ImagePair*> strongest;
  strongest.reserve(pairs.size());
  for (const ImagePair& pair : pairs) strongest.push_back(&pair);
  std::stable_sort(strongest.begin(), strongest.end(),
                   [](const ImagePair* a, const ImagePair* b) { return a->matches.size() > b->matches.size(); });
  for (const ImagePair* pair : strongest) {
    for (const auto& [a, b] : pair->matches) {
      int into = track_of[offset[pair->first] + a], from = track_of[offset[pair->second] + b];
      if (into == from) continue;
      if (tracks[into].size() < tracks[from].size()) std::swap(into, from);
      if (share_an_image(tracks[into], tracks[from])) continue;
      Track joined;
      std::merge(tracks[into].begin(), tracks[into].end(), tracks[from].begin(), tracks[from].end(),
                 std::back_inserter(joined));
      for (const auto& [image, keypoint] : tracks[from]) track_of[offset[image] + keypoint] = into;
      tracks[into] = std::move(joined);
      tracks[from].clear();
    }
  }
  std::erase_if(tracks, [](const Track& track) { return track.size() < 2; });
  std::sort(tracks.begin(), tracks.end());
  return tracks;
}

}  // namespace rumi::ruminator
