// SPDX-License-Identifier: BSD-3-Clause
#include "camera_driver/recording/video_stream.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "camera_driver/recording/library_messages.h"

namespace rumi::camera_driver {

VideoStream::VideoStream(Format format, int index)
    : format_(std::move(format)), index_(index), packet_(av_packet_alloc()) {}

std::unique_ptr<VideoStream> VideoStream::open(const std::filesystem::path& file) {
  log_what_ffmpeg_says();
  AVFormatContext* opened = nullptr;
  // "file:" so that a name with a colon is no protocol.
  if (avformat_open_input(&opened, ("file:" + file.string()).c_str(), nullptr, nullptr) < 0) return nullptr;
  Format format(opened);
  if (std::string_view(format->iformat->name) == "tty") return nullptr;  // any text
  if (avformat_find_stream_info(format.get(), nullptr) < 0) return nullptr;
  const int index = av_find_best_stream(format.get(), AVMEDIA_TYPE_VIDEO, -1, -1, nullptr, 0);
  if (index < 0) return nullptr;
  return std::unique_ptr<VideoStream>(new VideoStream(std::move(format), index));
}

const AVPacket* VideoStream::next() {
  while (packet_) {
    av_packet_unref(packet_.get());  // FFmpeg would leave what it holds
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

// FFmpeg's own guesses from the size and from what is there do not count.
int64_t VideoStream::promised_us() const {
  const bool is_said = std::string_view(format_->iformat->name).starts_with("matroska") && format_->duration > 0 &&
                       format_->duration_estimation_method == AVFMT_DURATION_FROM_STREAM;
  return is_said ? format_->duration : 0;
}

int VideoStream::video_streams() const {
  const auto is_video = [](const AVStream* stream) {
    return stream->codecpar->codec_type == AVMEDIA_TYPE_VIDEO && !(stream->disposition & AV_DISPOSITION_ATTACHED_PIC);
  };
  return static_cast<int>(std::count_if(format_->streams, format_->streams + format_->nb_streams, is_video));
}

bool VideoStream::is_bare() const {
  static constexpr std::array<std::string_view, 11> kBare = {"h264", "hevc", "mjpeg", "mpegvideo", "m4v",      "h261",
                                                             "h263", "vc1",  "obu",   "dirac",     "cavsvideo"};
  const std::string_view name = format_->iformat->name;
  return name.ends_with("_pipe") || std::find(kBare.begin(), kBare.end(), name) != kBare.end();
}

std::optional<int64_t> usable_time(int64_t stored) {
  constexpr int64_t kMost = int64_t{1} << 61;  // so that a difference is a number
  return stored < -kMost || stored > kMost ? std::nullopt : std::optional(stored);
}

}  // namespace rumi::camera_driver
