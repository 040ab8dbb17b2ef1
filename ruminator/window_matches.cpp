// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/window_matches.h"

#include <algorithm>
#include <numeric>

namespace rumi {

std::vector<ColmapPair> match_window(const Camera& camera, const std::vector<SiftFeatures>& images,
                                     const SiftMatchOptions& options, const PairSelection& selection,
                                     const std::function<void(double)>& progress, const std::atomic<bool>& cancel) {
  const int count = static_cast<int>(images.size());
  std::vector<ColmapPair> pairs;
  int64_t done = 0;
  const int64_t all = static_cast<int64_t>(count) * (count - 1) / 2;
  for (int j = 1; j < count && !cancel; ++j) {
    for (int i = 0; i < j && !cancel; ++i) {
      if (j - i > selection.near) {
        const IndexPairs preview = match_sift(images[i], images[j], options, options.preview_keypoints);
        if (static_cast<int>(preview.size()) < options.preview_matches) continue;
      }
      const IndexPairs matches = match_sift(images[i], images[j], options);
      IndexPairs verified = verify_matches(camera, images[i], images[j], matches, options);
      if (!verified.empty()) pairs.push_back({i, j, std::move(verified)});
    }
    done += j;
    progress(static_cast<double>(done) / static_cast<double>(all));
  }
  std::sort(pairs.begin(), pairs.end(), [](const ColmapPair& a, const ColmapPair& b) {
    return std::pair(a.first, a.second) < std::pair(b.first, b.second);
  });
  return pairs;
}

std::vector<int> connected_images(int images, const std::vector<ColmapPair>& pairs, int min_matches) {
  std::vector<int> parent(images);
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&parent](int i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  for (const ColmapPair& pair : pairs)
    if (static_cast<int>(pair.matches.size()) >= min_matches) parent[root(pair.first)] = root(pair.second);

  std::vector<int> size(images, 0), roots;
  for (int i = 0; i < images; ++i)
    if (size[root(i)]++ == 0) roots.push_back(root(i));
  std::stable_sort(roots.begin(), roots.end(), [&size](int a, int b) { return size[a] > size[b]; });
  std::vector<int> group(images);
  for (int i = 0; i < images; ++i)
    group[i] = static_cast<int>(std::find(roots.begin(), roots.end(), root(i)) - roots.begin());
  return group;
}

}  // namespace rumi
