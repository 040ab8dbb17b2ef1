// SPDX-License-Identifier: BSD-3-Clause
// What a video file has stored, packet by packet, not decoded (FFmpeg's libavformat).
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>

extern "C" {
#include <libavformat/avformat.h>
}

namespace rumi::camera_driver {

class VideoStream {
 public:
  // The best video stream of the file. Null if there is none, or the file cannot be read.
  static std::unique_ptr<VideoStream> open(const std::filesystem::path& file);

  // The next packet, valid until the next call; null after the last one.
  const AVPacket* next();

  const AVStream& stream() const { return *format_->streams[index_]; }
  // How long the file is by its own header, all its streams together; 0 if it does not say.
  int64_t promised_us() const;
  // The end of what was read so far, of all streams.
  int64_t end_us() const { return end_us_; }
  int video_streams() const;  // in the file; pictures of the cover are none
  // It has no container: FFmpeg counts its frames at 25 Hz, whatever they are.
  bool is_bare() const;

 private:
  struct CloseFormat {
    void operator()(AVFormatContext* format) const { avformat_close_input(&format); }
  };
  struct FreePacket {
    void operator()(AVPacket* packet) const { av_packet_free(&packet); }
  };
  using Format = std::unique_ptr<AVFormatContext, CloseFormat>;

  VideoStream(Format format, int index);

  Format format_;
  void note_end();
  int index_;
  int64_t end_us_ = 0;
  std::unique_ptr<AVPacket, FreePacket> packet_;
};

// Of a packet or a picture, in the unit of its stream; nothing if there is none.
std::optional<int64_t> usable_time(int64_t stored);

}  // namespace rumi::camera_driver
