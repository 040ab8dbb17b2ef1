// SPDX-License-Identifier: BSD-3-Clause
#include "formats/video/video_stream.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "formats/image/library_messages.h"

extern "C" {
#include <libavutil/display.h>
}

namespace rumi {
namespace {

// Returns nullptr if the video does not say how the camera was held.
const int32_t* display_matrix(const AVStream& stream) {
#if LIBAVFORMAT_VERSION_INT >= AV_VERSION_INT(60, 15, 100)
  const AVCodecParameters& parameters = *stream.codecpar;
  const AVPacketSideData* data =
      av_packet_side_data_get(parameters.coded_side_data, parameters.nb_coded_side_data, AV_PKT_DATA_DISPLAYMATRIX);
  return data ? reinterpret_cast<const int32_t*>(data->data) : nullptr;
#else
  return reinterpret_cast<const int32_t*>(av_stream_get_side_data(&stream, AV_PKT_DATA_DISPLAYMATRIX, nullptr));
#endif
}

}  // namespace

VideoStream::VideoStream(VideoFormat format, int index)
    : format_(std::move(format)), index_(index), packet_(av_packet_alloc()) {}

VideoFormat open_video_format(const std::filesystem::path& file) {
  log_what_ffmpeg_says();
  AVFormatContext* opened = nullptr;
  // The prefix keeps FFmpeg from taking a name with a colon for a protocol.
  if (avformat_open_input(&opened, ("file:" + file.string()).c_str(), nullptr, nullptr) < 0) return nullptr;
  VideoFormat format(opened);
  if (std::string_view(format->iformat->name) == "tty") return nullptr;  // FFmpeg takes any text for such a video
  if (avformat_find_stream_info(format.get(), nullptr) < 0) return nullptr;
  return format;
}

std::unique_ptr<VideoStream> VideoStream::open(const std::filesystem::path& file, int number) {
  VideoFormat format = open_video_format(file);
  const bool is_there = format && number >= 0 && static_cast<unsigned>(number) < format->nb_streams &&
                        format->streams[number]->codecpar->codec_type == AVMEDIA_TYPE_VIDEO;
  if (!is_there) return nullptr;
  return std::unique_ptr<VideoStream>(new VideoStream(std::move(format), number));
}

const AVPacket* VideoStream::next() {
  while (packet_) {
    av_packet_unref(packet_.get());  // FFmpeg does not free what the packet holds
    if (av_read_frame(format_.get(), packet_.get()) < 0) return nullptr;
    note_end();
    if (packet_->stream_index == index_) return packet_.get();
  }
  return nullptr;
}

void VideoStream::note_end() {
  const std::optional<int64_t> begin = usable_time(packet_->pts != AV_NOPTS_VALUE ? packet_->pts : packet_->dts);
  if (!begin) return;
  const AVStream& stream = *format_->streams[packet_->stream_index];
  const int64_t length = std::clamp<int64_t>(packet_->duration, 0, int64_t{1} << 61);
  end_us_ = std::max(end_us_, av_rescale_q(*begin + length, stream.time_base, AVRational{1, 1'000'000}));
}

// Takes the length only if the header gives it, and not FFmpeg's own guesses from the size and from the packets.
int64_t VideoStream::promised_us() const {
  const bool is_said = std::string_view(format_->iformat->name).starts_with("matroska") && format_->duration > 0 &&
                       format_->duration_estimation_method == AVFMT_DURATION_FROM_STREAM;
  return is_said ? format_->duration : 0;
}

bool VideoStream::is_bare() const {
  static constexpr std::array<std::string_view, 11> kBare = {"h264", "hevc", "mjpeg", "mpegvideo", "m4v",      "h261",
                                                             "h263", "vc1",  "obu",   "dirac",     "cavsvideo"};
  const std::string_view name = format_->iformat->name;
  return name.ends_with("_pipe") || std::find(kBare.begin(), kBare.end(), name) != kBare.end();
}

int quarter_turns(const AVStream& stream) {
  const int32_t* matrix = display_matrix(stream);
  const double degrees = matrix ? av_display_rotation_get(matrix) : 0;  // counter-clockwise, -180 to 180
  return std::isfinite(degrees) ? static_cast<int>((std::lround(degrees / 90) + 4) % 4) : 0;
}

std::optional<int64_t> usable_time(int64_t stored) {
  constexpr int64_t kMost = int64_t{1} << 61;  // limits times, so that differences do not overflow
  return stored < -kMost || stored > kMost ? std::nullopt : std::optional(stored);
}

}  // namespace rumi
