// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/session_gate.h"

#include <fmt/format.h>

#include <utility>

#include "bus/wire/calibration.h"
#include "bus/wire/image_codec.h"
#include "bus/wire/image_stream.h"

namespace rumi::front_tracker {
namespace {

using Kind = RefusedImages::Kind;
using Decision = SessionGate::Decision;
using What = SessionGate::Decision::What;

// If so many images in a row have another calibration or stream, the camera was changed or a recording was started
// again. If images of the session come between them, they are from a second camera.
constexpr size_t kImagesOfNewSession = 10;

}  // namespace

Decision SessionGate::judge(const ArrivedImage& arrived) {
  const int64_t stream = stream_of(arrived.image);
  if (session_ && stream != kNoStream && stream != session_->stream)
    return wait_as_foreign(arrived, fmt::format("it is of stream {}, and the session's images are of stream {}", stream,
                                                session_->stream));
  return judge_time(arrived);
}

Decision SessionGate::judge_time(const ArrivedImage& arrived) {
  const image_t& image = arrived.image;
  const int64_t last_us = times_.last_us();
  const bool is_checked = !metadata(image, kPublishedKey).empty();
  Decision retake{.what = What::kRetake};
  switch (times_.judge(image.utime, arrived.arrived_us, is_checked)) {
    case ImageTimes::Verdict::kNext:
      return judge_camera(arrived);
    case ImageTimes::Verdict::kDoubled:
      return refusal(Kind::kDoubled, fmt::format("its utime {} is that of the image before", image.utime));
    case ImageTimes::Verdict::kWaits:
      return wait_for_times(arrived, last_us);
    case ImageTimes::Verdict::kBegins:
      if (session_)
        retake.why_session_ends = fmt::format("the camera's time went back by {:.3f} s",
                                              1e-6 * static_cast<double>(last_us - waiting_.front().image.utime));
      session_.reset();
      break;
    case ImageTimes::Verdict::kGoesOn:
      break;
  }
  retake.next = stop_waiting();
  retake.next.push_back(arrived);
  return retake;
}

Decision SessionGate::judge_camera(const ArrivedImage& arrived) {
  if (given_camera_) return judge_size(arrived.image, *given_camera_);
  const std::string text(metadata(arrived.image, kCalibrationKey));
  if (session_ && (text.empty() || text == session_->calibration)) return judge_size(arrived.image, session_->camera);
  if (text.empty())
    return refusal(Kind::kCalibration,
                   "it carries no calibration: give the camera's with --camera FILE (front_tracker, rumi up)");
  const Result<Calibration> parsed = parse_calibration(text, "calibration of the image");
  if (!parsed) return refusal(Kind::kCalibration, parsed.error_text());
  if (!session_) return judge_size(arrived.image, parsed->camera);
  const Camera &other = parsed->camera, &ours = session_->camera;
  return wait_as_foreign(
      arrived, fmt::format("it is calibrated as {} x {} px with fx {:.2f}, and the session's images as {} x {} px with "
                           "fx {:.2f}",
                           other.width, other.height, other.fx, ours.width, ours.height, ours.fx));
}

Decision SessionGate::judge_size(const image_t& image, const Camera& camera) {
  times_.forget_row();
  give_up_waiting();
  if (image.width != camera.width || image.height != camera.height)
    return refusal(Kind::kSize, fmt::format("it is {}x{} but the calibration is for {}x{}", image.width, image.height,
                                            camera.width, camera.height));
  return {.what = What::kTrack, .camera = camera};
}

void SessionGate::take(const ArrivedImage& arrived) {
  problem_.clear();
  times_.take(arrived.image.utime, arrived.arrived_us);
}

void SessionGate::begin_session(const Camera& camera, const image_t& image, int64_t stream) {
  session_ = {camera, std::string(metadata(image, kCalibrationKey)), stream};
}

void SessionGate::refuse(Kind kind, const std::string& problem) {
  problem_ = problem;
  refused_.add(kind, problem);
}

Decision SessionGate::refusal(Kind kind, const std::string& problem) {
  refuse(kind, problem);
  return {.what = What::kRefused};
}

Decision SessionGate::wait(Kind kind, const ArrivedImage& arrived, const std::string& problem) {
  if (waiting_kind_ != kind) give_up_waiting();
  waiting_kind_ = kind;
  problem_ = waiting_problem_ = problem;
  waiting_.push_back(arrived);
  refused_.count(kind);
  return {.what = What::kWaits};
}

Decision SessionGate::wait_as_foreign(const ArrivedImage& arrived, const std::string& problem) {
  times_.forget_row();
  Decision decision = wait(Kind::kOtherCamera, arrived,
                           problem + ": if two cameras publish on this channel, give one of them another (--channel)");
  if (waiting_.size() < kImagesOfNewSession) return decision;
  session_.reset();
  times_.begin_session();
  return {.what = What::kRetake,
          .next = stop_waiting(),
          .why_session_ends = "the images are of another camera or recording"};
}

Decision SessionGate::wait_for_times(const ArrivedImage& arrived, int64_t last_us) {
  const int64_t utime_us = arrived.image.utime;
  const std::string no_time = times_.what_is_wrong() + ": utime must be microseconds since 1970";
  // An image that begins a row has nothing to do with those that wait, and shows what was wrong with their times.
  if (times_.row() == 1) {
    if (waiting_kind_ == Kind::kNoTime) waiting_problem_ = no_time;
    give_up_waiting();
  }
  if (times_.are_none() || times_.doubt() == ImageTimes::Doubt::kNoTime) return wait(Kind::kNoTime, arrived, no_time);
  if (times_.doubt() == ImageTimes::Doubt::kAhead)
    return wait(Kind::kAhead, arrived,
                fmt::format("its utime {} is {:.3f} s after the last, and the next ones are not", utime_us,
                            1e-6 * static_cast<double>(utime_us - last_us)));
  return wait(Kind::kOlder, arrived, fmt::format("its utime {} is older than the last, {}", utime_us, last_us));
}

void SessionGate::give_up_waiting() {
  if (!waiting_.empty()) refused_.tell(waiting_kind_, waiting_problem_);
  waiting_.clear();
}

std::vector<ArrivedImage> SessionGate::stop_waiting() {
  refused_.take_back(waiting_kind_, static_cast<int64_t>(waiting_.size()));
  return std::exchange(waiting_, {});
}

}  // namespace rumi::front_tracker
