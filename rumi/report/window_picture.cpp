// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/report/window_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "lcmtypes/rumi/track_t.hpp"
#include "viewer_offscreen/canvas/plot_canvas.h"
#include "viewer_offscreen/canvas/text.h"

namespace rumi::tool {
namespace {

// All positions and lengths are in pixels of the final picture.
constexpr int kWidth = 1600, kHeight = 580, kMargin = 24;
constexpr int kThumbWidth = 120, kThumbGap = 8;
constexpr double kTopThumbs = 78, kStrip = 262, kStripHeight = 30, kMarks = 318, kBrackets = 342, kBottomThumbs = 420;

// Okabe and Ito's colours (RGB), which people with any kind of colour vision can tell apart.
const cv::Vec3b kTracked(0, 114, 178), kPosedAfterwards(86, 180, 233), kRecentlyLost(230, 159, 0), kLost(213, 94, 0),
    kNotInitialized(170, 170, 170);
const cv::Vec3b kApproach(0, 158, 115), kGap(204, 121, 167), kDeparture(60, 60, 60);
const cv::Vec3b kInk(40, 40, 44), kFaint(190, 190, 194), kWhite(255, 255, 255);

const cv::Vec3b& colour_of(const SceneFrame& frame) {
  switch (frame.state) {
    case track_t::TRACKING:
      return kTracked;
    case track_t::RECENTLY_LOST:
      return frame.has_pose ? kPosedAfterwards : kRecentlyLost;
    case track_t::LOST:
      return frame.has_pose ? kPosedAfterwards : kLost;
    default:
      return frame.has_pose ? kPosedAfterwards : kNotInitialized;
  }
}

const cv::Vec3b& colour_of(SampledAs part) {
  return part == SampledAs::kApproach ? kApproach : part == SampledAs::kGap ? kGap : kDeparture;
}

// The picture. It is drawn enlarged, and finish() reduces it, which makes edges smooth.
class Paper {
 public:
  Paper() : large_(kHeight * kScale, kWidth * kScale, CV_8UC3, cv::Scalar::all(255)) {}

  void line(cv::Point2d a, cv::Point2d b, double width, const cv::Vec3b& rgb) {
    cv::line(large_, scaled(a), scaled(b), bgr(rgb), std::max(1, cvRound(width * kScale)), cv::LINE_AA);
  }
  void box(cv::Rect2d area, const cv::Vec3b& rgb) {
    cv::rectangle(large_, scaled(area.tl()), scaled(area.br()) - cv::Point(1, 1), bgr(rgb), cv::FILLED);
  }
  void frame(cv::Rect2d area, double width, const cv::Vec3b& rgb) {
    cv::rectangle(large_, scaled(area.tl()), scaled(area.br()), bgr(rgb), std::max(1, cvRound(width * kScale)));
  }
  void polygon(const std::vector<cv::Point2d>& corners, const cv::Vec3b& rgb) {
    std::vector<cv::Point> points;
    points.reserve(corners.size());
    for (const cv::Point2d& corner : corners) points.push_back(scaled(corner));
    cv::fillPoly(large_, points, bgr(rgb), cv::LINE_AA);
  }
  void disc(cv::Point2d center, double radius, const cv::Vec3b& rgb) {
    cv::circle(large_, scaled(center), cvRound(radius * kScale), bgr(rgb), cv::FILLED, cv::LINE_AA);
  }
  void text(cv::Point2d at, const std::string& words, double height = 9, bool bold = false,
            const cv::Vec3b& rgb = kInk) {
    viewer_offscreen::draw_text(large_, at, words, {height, rgb, bold});
  }
  void text_around(cv::Point2d at, const std::string& words, double height = 9, bool bold = false,
                   const cv::Vec3b& rgb = kInk) {
    const double half = viewer_offscreen::text_width(words, {height, rgb, bold}) / 2;
    text({std::clamp(at.x - half, 4.0, kWidth - 2 * half - 4), at.y}, words, height, bold, rgb);
  }
  void image(cv::Rect2d area, const cv::Mat& image) {
    const cv::Rect pixels(scaled(area.tl()), scaled(area.br()));
    if (image.empty()) {
      box(area, kFaint);
      return text_around({area.x + area.width / 2, area.y + area.height / 2}, "no image", 7);
    }
    cv::resize(image, large_(pixels), pixels.size(), 0, 0, cv::INTER_LINEAR);
  }
  cv::Mat finish() const {
    cv::Mat picture;
    cv::resize(large_, picture, {kWidth, kHeight}, 0, 0, cv::INTER_AREA);
    return picture;
  }

 private:
  static constexpr int kScale = viewer_offscreen::PlotCanvas::kScale;
  static cv::Point scaled(cv::Point2d p) { return {cvRound(p.x * kScale), cvRound(p.y * kScale)}; }
  static cv::Scalar bgr(const cv::Vec3b& rgb) { return {double(rgb[2]), double(rgb[1]), double(rgb[0])}; }
  cv::Mat large_;
};

class Picture {
 public:
  explicit Picture(const WindowScene& scene) : scene_(scene), frames_(scene.frames) {
    cell_width_ = static_cast<double>(kWidth - 2 * kMargin) / static_cast<double>(frames_.size());
    const auto seen =
        std::find_if(frames_.begin(), frames_.end(), [](const SceneFrame& f) { return !f.image.empty(); });
    if (seen != frames_.end()) thumb_height_ = kThumbWidth * seen->image.rows / static_cast<double>(seen->image.cols);
    thumb_height_ = std::min(thumb_height_, kStrip - kTopThumbs - 60);
  }

  cv::Mat draw() {
    draw_title();
    draw_captured();
    draw_strip();
    draw_events();
    draw_samples();
    draw_legend();
    return paper_.finish();
  }

 private:
  double center_of(size_t index) const { return kMargin + (static_cast<double>(index) + 0.5) * cell_width_; }
  double seconds(int64_t utime_us) const { return 1e-6 * static_cast<double>(utime_us - scene_.begin_us); }
  static size_t thumbs_in_a_row() { return (kWidth - 2 * kMargin + kThumbGap) / (kThumbWidth + kThumbGap); }
  // Returns the index of the first frame at or after the time.
  size_t index_of(int64_t utime_us) const {
    const auto it = std::lower_bound(frames_.begin(), frames_.end(), utime_us,
                                     [](const SceneFrame& f, int64_t utime) { return f.utime_us < utime; });
    return static_cast<size_t>(it - frames_.begin());
  }

  void draw_title() {
    const window_t& w = scene_.window;
    const auto submap = [](int32_t id) { return id == 0 ? std::string("nothing") : fmt::format("submap {}", id); };
    paper_.text({kMargin, 34},
                fmt::format("Rumination window {}: from {} to {}", w.window_id, submap(w.submap_before),
                            w.submap_after == 0 ? "the end" : submap(w.submap_after)),
                13, true);
    std::string counts = fmt::format(
        "{} frames captured, {} sampled: {} approach, {} of {} gap, {} departure; {} and {} keyframes shared",
        frames_.size(), w.napproach + w.ngap + w.ndeparture, w.napproach, w.ngap, w.gap_frames, w.ndeparture,
        w.shared_keyframes_before, w.shared_keyframes_after);
    if (!w.reason.empty()) counts += "; " + w.reason;
    paper_.text({kMargin, 58}, viewer_offscreen::fit_text(counts, kWidth - 2 * kMargin, {9}), 9);
  }

  // Draws a row of images, and lines that lead to their cells of the strip.
  void draw_row(const std::vector<size_t>& chosen, double top, bool is_above) {
    const double pitch = kThumbWidth + kThumbGap;
    const double width = pitch * static_cast<double>(chosen.size()) - kThumbGap;
    double left = (kWidth - width) / 2;
    for (const size_t index : chosen) {
      const SceneFrame& frame = frames_[index];
      const cv::Rect2d area(left, top, kThumbWidth, thumb_height_);
      const double middle = left + kThumbWidth / 2.0;
      const cv::Vec3b& colour = is_above ? colour_of(frame) : colour_of(frame.sampled_as);
      if (is_above)
        paper_.line({middle, top + thumb_height_}, {center_of(index), kStrip}, 0.6, kFaint);
      else
        paper_.line({middle, top}, {center_of(index), kMarks + 6}, 0.6, colour);
      paper_.image(area, frame.image);
      paper_.frame(area, is_above ? 1.5 : 2, colour);
      if (!is_above) {
        std::string label = fmt::format("{:.2f} s", seconds(frame.utime_us));
        if (frame.is_keyframe) label += ", key";
        paper_.text_around({middle, top + thumb_height_ + 15}, label, 8);
      }
      left += pitch;
    }
  }

  static std::vector<size_t> spread(const std::vector<size_t>& all, size_t count) {
    if (all.size() <= count) return all;
    std::vector<size_t> chosen;
    for (size_t i = 0; i < count; ++i) chosen.push_back(all[count == 1 ? 0 : i * (all.size() - 1) / (count - 1)]);
    return chosen;
  }

  void draw_captured() {
    std::vector<size_t> all(frames_.size());
    for (size_t i = 0; i < all.size(); ++i) all[i] = i;
    draw_row(spread(all, thumbs_in_a_row()), kTopThumbs, true);
  }

  void draw_strip() {
    for (size_t i = 0; i < frames_.size(); ++i) {
      const double left = center_of(i) - cell_width_ / 2;
      const double gap = cell_width_ > 4 ? 1 : 0;
      paper_.box({left, kStrip, cell_width_ - gap, kStripHeight}, colour_of(frames_[i]));
      if (frames_[i].is_keyframe)
        paper_.line({center_of(i), kStrip + 4}, {center_of(i), kStrip + kStripHeight - 4}, 1.5, kWhite);
    }
  }

  // Marks the time of a frame by a line through the strip.
  void draw_event(size_t index, const std::string& what, bool to_the_left) {
    const double x = center_of(index) - cell_width_ / 2, top = kStrip - 16;
    paper_.line({x, top - 4}, {x, kMarks + 8}, 1.5, kInk);
    const std::string label = fmt::format("{} {:.2f} s", what, seconds(frames_[index].utime_us));
    const double width = viewer_offscreen::text_width(label, {9, kInk, true});
    const double left = std::clamp(to_the_left ? x - width - 5 : x + 5, 4.0, kWidth - width - 4);
    paper_.box({left - 2, top - 11, width + 4, 15}, kWhite);
    paper_.text({left, top}, label, 9, true);
  }

  void draw_events() {
    const window_t& w = scene_.window;
    const size_t lost = index_of(w.lost_utime), resumed = index_of(w.resumed_utime);
    if (lost < frames_.size()) draw_event(lost, "lost", true);
    if (w.resumed_utime != 0 && resumed < frames_.size()) draw_event(resumed, "resumed", false);
    const std::string first = fmt::format("{:.2f} s", seconds(frames_.front().utime_us));
    const std::string last = fmt::format("{:.2f} s", seconds(frames_.back().utime_us));
    if (lost > 40 / cell_width_ + 1) paper_.text({kMargin, kStrip - 6}, first, 8);
    paper_.text({kWidth - kMargin - viewer_offscreen::text_width(last, {8}), kStrip - 6}, last, 8);
  }

  // The three parts also differ in shape, for people who cannot see the colours.
  void draw_mark(const SceneFrame& frame, double x) {
    const double size = std::clamp(cell_width_ * 0.45, 1.5, 4.5);
    const cv::Vec3b& colour = colour_of(frame.sampled_as);
    if (frame.sampled_as == SampledAs::kApproach)
      paper_.disc({x, kMarks}, size, colour);
    else if (frame.sampled_as == SampledAs::kGap)
      paper_.box({x - size * 0.8, kMarks - size * 0.8, size * 1.6, size * 1.6}, colour);
    else
      paper_.polygon({{x, kMarks - size}, {x + size, kMarks + size}, {x - size, kMarks + size}}, colour);
    paper_.line({x, kStrip + kStripHeight}, {x, kMarks - size}, std::min(1.0, cell_width_ * 0.3), colour);
  }

  std::vector<size_t> samples_of(SampledAs part) const {
    std::vector<size_t> samples;
    for (size_t i = 0; i < frames_.size(); ++i)
      if (frames_[i].sampled_as == part) samples.push_back(i);
    return samples;
  }

  void draw_samples() {
    const std::vector<size_t> parts[] = {samples_of(SampledAs::kApproach), samples_of(SampledAs::kGap),
                                         samples_of(SampledAs::kDeparture)};
    const char* names[] = {"S1", "S2", "S3"};
    size_t total = 0;
    for (const auto& part : parts) total += part.size();
    std::vector<size_t> shown;
    const size_t room = thumbs_in_a_row();
    for (int p = 0; p < 3; ++p) {
      const std::vector<size_t>& part = parts[p];
      for (const size_t i : part) draw_mark(frames_[i], center_of(i));
      const size_t share = total <= room ? part.size() : std::max<size_t>(2, part.size() * room / total);
      const auto chosen = spread(part, std::min(share, p == 1 ? room - 4 : room / 3));
      shown.insert(shown.end(), chosen.begin(), chosen.end());
    }
    std::sort(shown.begin(), shown.end());
    draw_row(shown, kBottomThumbs, false);
    for (int p = 0; p < 3; ++p)
      if (!parts[p].empty()) draw_bracket(parts[p], names[p]);
  }

  void draw_bracket(const std::vector<size_t>& part, const char* name) {
    const double left = center_of(part.front()) - cell_width_ / 2, right = center_of(part.back()) + cell_width_ / 2;
    const cv::Vec3b& colour = colour_of(frames_[part.front()].sampled_as);
    paper_.line({left, kBrackets}, {right, kBrackets}, 2, colour);
    paper_.line({left, kBrackets}, {left, kBrackets - 6}, 2, colour);
    paper_.line({right, kBrackets}, {right, kBrackets - 6}, 2, colour);
    const std::string label = fmt::format("{}: {}", name, part.size());
    const double middle = (left + right) / 2, width = viewer_offscreen::text_width(label, {11, colour, true});
    paper_.box({middle - width / 2 - 3, kBrackets + 4, width + 6, 17}, kWhite);
    paper_.text_around({middle, kBrackets + 18}, label, 11, true, colour);
  }

  void draw_legend() {
    double x = kMargin;
    const double y = kHeight - 22;
    const auto entry = [&](const cv::Vec3b& colour, const char* words) {
      paper_.box({x, y - 10, 14, 12}, colour);
      paper_.text({x + 20, y}, words, 9);
      x += 20 + viewer_offscreen::text_width(words, {9}) + 22;
    };
    entry(kTracked, "tracked");
    entry(kPosedAfterwards, "got its pose afterwards");
    entry(kRecentlyLost, "recently lost");
    entry(kLost, "lost");
    entry(kNotInitialized, "not initialized");
    paper_.box({x, y - 10, 14, 12}, kTracked);
    paper_.line({x + 7, y - 8}, {x + 7, y}, 1.5, kWhite);
    paper_.text({x + 20, y}, "keyframe", 9);
    x += 110;
    paper_.disc({x, y - 4}, 4.5, kApproach);
    paper_.text({x + 12, y}, "approach S1", 9);
    x += 116;
    paper_.box({x - 4, y - 8, 8, 8}, kGap);
    paper_.text({x + 12, y}, "gap S2", 9);
    x += 84;
    paper_.polygon({{x, y - 9}, {x + 5, y}, {x - 5, y}}, kDeparture);
    paper_.text({x + 12, y}, "departure S3", 9);
  }

  const WindowScene& scene_;
  const std::vector<SceneFrame>& frames_;
  double cell_width_ = 1, thumb_height_ = 90;
  Paper paper_;
};

}  // namespace

cv::Mat draw_window(const WindowScene& scene) { return Picture(scene).draw(); }

}  // namespace rumi::tool
