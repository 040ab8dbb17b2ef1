// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/patches/patch_templates.h"

namespace rumi::front_tracker {
namespace {

constexpr float kSameShape = 0.02F;  // largest difference in elements of frame_from_keyframe with which a template is
                                     // used again
constexpr int kKeptFrames = 8;

bool looks_the_same(const PatchTemplates::Patch& a, const PatchTemplates::Patch& b) {
  return a.pixel == b.pixel && (a.frame_from_keyframe - b.frame_from_keyframe).cwiseAbs().maxCoeff() < kSameShape;
}

}  // namespace

const PatchTemplate* PatchTemplates::find(const ImagePyramid& keyframe_images, const Patch& patch) {
  const uint64_t key = static_cast<uint64_t>(patch.seen.keyframe_id) << 32 |
                       static_cast<uint32_t>(patch.seen.keypoint_index) << 8 | patch.octave;
  const auto [at, is_new] = entries_.try_emplace(key);
  Entry& entry = at->second;
  const bool is_forgotten = is_new || entry.used + kKeptFrames < frame_;
  entry.used = frame_;
  if (is_forgotten || !looks_the_same(entry.patch, patch)) {
    entry.patch = patch;
    entry.made = make_patch_template(keyframe_images, patch.pixel, patch.frame_from_keyframe,
                                     keyframe_images.pixel_size(patch.octave).x());
  }
  return entry.made ? &*entry.made : nullptr;
}

void PatchTemplates::end_frame() {
  // Not done after every frame, because there are thousands of templates.
  if (frame_ % kKeptFrames == 0)
    std::erase_if(entries_, [this](const auto& entry) { return entry.second.used + kKeptFrames <= frame_; });
  ++frame_;
}

}  // namespace rumi::front_tracker
