// SPDX-License-Identifier: BSD-3-Clause
#include "camera_driver/recording/video_times.h"

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <string_view>

extern "C" {
#include <libavformat/avformat.h>
}

namespace rumi::camera_driver {
namespace {

struct CloseFormat {
  void operator()(AVFormatContext* format) const { avformat_close_input(&format); }
};
struct FreePacket {
  void operator()(AVPacket* packet) const { av_packet_free(&packet); }
};
using Format = std::unique_ptr<AVFormatContext, CloseFormat>;

Format open(const std::filesystem::path& file) {
  // What is wrong with the file is said by us. A level would not do: OpenCV sets another one.
  av_log_set_callback([](void*, int, const char*, va_list) {});
  AVFormatContext* opened = nullptr;
  // "file:" so that a name with a colon is no protocol.
  if (avformat_open_input(&opened, ("file:" + file.string()).c_str(), nullptr, nullptr) < 0) return nullptr;
  Format format(opened);
  if (std::string_view(format->iformat->name) == "tty") return nullptr;  // any text
  format->flags |= AVFMT_FLAG_GENPTS;  // MPEG's program streams have a time now and then
  return format;
}

// What has no container: FFmpeg counts its frames at 25 Hz, whatever they are.
bool is_bare_stream(std::string_view format) {
  static constexpr std::array<std::string_view, 11> kBare = {"h264", "hevc", "mjpeg", "mpegvideo", "m4v",      "h261",
                                                             "h263", "vc1",  "obu",   "dirac",     "cavsvideo"};
  return format.ends_with("_pipe") || std::find(kBare.begin(), kBare.end(), format) != kBare.end();
}

// Some containers have no time of showing: there the order of decoding is that of showing. Nothing where there is
// neither, or where it is beyond all times.
std::optional<int64_t> time_of(const AVPacket& packet, AVRational unit) {
  constexpr int64_t kMostUs = int64_t{1} << 53;
  const int64_t time = packet.pts != AV_NOPTS_VALUE ? packet.pts : packet.dts;
  if (time == AV_NOPTS_VALUE || unit.num <= 0 || unit.den <= 0) return std::nullopt;
  const int64_t utime_us = av_rescale_q(time, unit, AVRational{1, 1'000'000});
  return utime_us > -kMostUs && utime_us < kMostUs ? std::optional(utime_us) : std::nullopt;
}

// The order of showing differs from that of decoding by a few frames. Farther back the clock began anew: that stays.
void sort_as_shown(std::vector<int64_t>* utimes) {
  constexpr int64_t kBeganAnewUs = 1'000'000;
  auto begin = utimes->begin();
  int64_t latest_us = INT64_MIN;
  for (auto it = utimes->begin(); it != utimes->end(); ++it) {
    if (it != begin && *it < latest_us - kBeganAnewUs) {
      std::sort(begin, it);
      begin = it;
      latest_us = *it;
    }
    latest_us = std::max(latest_us, *it);
  }
  std::sort(begin, utimes->end());
}

}  // namespace

VideoTimes read_video_times(const std::filesystem::path& file) {
  VideoTimes times;
  const Format format = open(file);
  if (!format || avformat_find_stream_info(format.get(), nullptr) < 0) return times;
  const int stream = av_find_best_stream(format.get(), AVMEDIA_TYPE_VIDEO, -1, -1, nullptr, 0);
  if (stream < 0) return times;
  const AVRational unit = format->streams[stream]->time_base;
  const std::unique_ptr<AVPacket, FreePacket> packet(av_packet_alloc());
  size_t without = 0;
  while (packet && av_read_frame(format.get(), packet.get()) >= 0) {
    if (packet->stream_index == stream) ++times.stored;
    const bool is_shown = packet->stream_index == stream && (packet->flags & AV_PKT_FLAG_DISCARD) == 0;
    if (is_shown) {
      const std::optional<int64_t> utime_us = time_of(*packet, unit);
      times.utimes.push_back(utime_us.value_or(0));
      without += utime_us ? 0 : 1;
    }
    av_packet_unref(packet.get());
  }
  times.promised = std::max<int64_t>(0, format->streams[stream]->nb_frames);
  times.has_times = !is_bare_stream(format->iformat->name) && 2 * without < times.utimes.size();
  if (!times.has_times) std::fill(times.utimes.begin(), times.utimes.end(), 0);
  sort_as_shown(&times.utimes);
  if (times.utimes.empty()) return times;
  const int64_t first_us = *std::min_element(times.utimes.begin(), times.utimes.end());
  for (int64_t& utime_us : times.utimes) utime_us -= first_us;
  return times;
}

}  // namespace rumi::camera_driver
