// SPDX-License-Identifier: BSD-3-Clause
#include "formats/video/video_times.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "formats/video/video_decoder.h"

namespace rumi {
namespace {

struct PacketTimes {
  int64_t shown = 0, decoded = 0;
};

// Sorts the times of showing. Their order differs from that of decoding, by more than a second if the recorder paused.
// Times of decoding rise: if they go back by more than `began_anew`, the clock began anew, and earlier pictures stay
// before later ones.
std::vector<int64_t> sorted_as_shown(const std::vector<PacketTimes>& packets, int64_t began_anew) {
  std::vector<int64_t> stamps;
  size_t begin = 0;
  int64_t latest = INT64_MIN / 2;
  for (const PacketTimes& packet : packets) {
    if (packet.decoded < latest - began_anew) {
      std::sort(stamps.begin() + static_cast<std::ptrdiff_t>(begin), stamps.end());
      begin = stamps.size();
      latest = packet.decoded;
    }
    latest = std::max(latest, packet.decoded);
    stamps.push_back(packet.shown);
  }
  std::sort(stamps.begin() + static_cast<std::ptrdiff_t>(begin), stamps.end());
  return stamps;
}

constexpr double kFarthest = 1e18;  // farthest time, in any unit

// Interpolates linearly between known times, and continues with the usual step beyond them. Returns false if fewer than
// two are known.
bool fill_gaps(const std::vector<std::optional<int64_t>>& stamps, std::vector<int64_t>* filled) {
  std::vector<size_t> known;
  for (size_t i = 0; i < stamps.size(); ++i)
    if (stamps[i]) known.push_back(i);
  filled->assign(stamps.size(), 0);
  if (known.size() < 2) return false;
  size_t after = 1;  // index in `known`: the line goes through this time and the one before it
  for (size_t i = 0; i < stamps.size(); ++i) {
    while (after + 1 < known.size() && known[after] < i) ++after;
    const auto from = known[after - 1], to = known[after];
    const double step = static_cast<double>(*stamps[to] - *stamps[from]) / static_cast<double>(to - from);
    const double places = static_cast<double>(i) - static_cast<double>(from);
    (*filled)[i] =
        stamps[i] ? *stamps[i]
                  : std::llround(std::clamp(static_cast<double>(*stamps[from]) + places * step, -kFarthest, kFarthest));
  }
  return true;
}

// Reads the times of the pictures as the decoder gives them, in the order of showing. Returns false if they have no
// times.
bool stamps_by_decoding(const std::filesystem::path& file, int stream, std::vector<int64_t>* stamps) {
  std::vector<std::optional<int64_t>> likely;
  const std::unique_ptr<VideoDecoder> decoder = VideoDecoder::open(file, stream);
  while (decoder && decoder->next()) likely.push_back(decoder->likely_stamp());
  return fill_gaps(likely, stamps);
}

std::vector<int64_t> in_microseconds(const std::vector<int64_t>& stamps, AVRational unit) {
  constexpr int64_t kLongestUs = int64_t{1} << 53;
  std::vector<int64_t> utimes;
  if (stamps.empty()) return utimes;
  const int64_t first = *std::min_element(stamps.begin(), stamps.end());
  for (const int64_t stamp : stamps) {
    const int64_t utime_us = av_rescale_q(stamp - first, unit, AVRational{1, 1'000'000});  // negative: beyond 64 bits
    utimes.push_back(utime_us < 0 ? kLongestUs : std::min(utime_us, kLongestUs));
  }
  return utimes;
}

}  // namespace

VideoTimes read_video_times(const std::filesystem::path& file, int stream) {
  VideoTimes times;
  const std::unique_ptr<VideoStream> video = VideoStream::open(file, stream);
  if (!video) return times;
  int64_t shown = 0;
  std::vector<PacketTimes> packets;
  while (const AVPacket* packet = video->next()) {
    ++times.stored;
    if ((packet->flags & AV_PKT_FLAG_DISCARD) != 0) continue;
    ++shown;
    if (const std::optional<int64_t> stamp = usable_time(packet->pts))
      packets.push_back({*stamp, usable_time(packet->dts).value_or(*stamp)});
  }
  times.promised = std::max<int64_t>(0, video->stream().nb_frames);
  if (const int64_t promised_us = video->promised_us(); promised_us > 0 && video->end_us() > 0) {
    const double part = static_cast<double>(promised_us) / static_cast<double>(video->end_us());
    times.promised = std::llround(std::min(static_cast<double>(times.stored) * part, kFarthest));
    times.is_promise_by_length = true;
  }
  constexpr double kEarly = 0.97;
  const int64_t length_us =
      av_rescale_q(std::max<int64_t>(0, video->stream().duration), video->stream().time_base, AVRational{1, 1'000'000});
  times.ends_early =
      times.is_promise_by_length || static_cast<double>(video->end_us()) < kEarly * static_cast<double>(length_us);
  if (shown == 0) return times;
  const AVRational unit = video->stream().time_base;
  if (video->is_bare()) {
    times.utimes.assign(static_cast<size_t>(shown), 0);
  } else if (static_cast<int64_t>(packets.size()) == shown) {
    times.stamps = sorted_as_shown(packets, av_rescale_q(1, AVRational{1, 1}, unit));
    times.utimes = in_microseconds(times.stamps, unit);
    times.has_times = true;
  } else {
    std::vector<int64_t> likely;
    times.has_times = stamps_by_decoding(file, stream, &likely);
    times.utimes = in_microseconds(likely, unit);
  }
  return times;
}

}  // namespace rumi
