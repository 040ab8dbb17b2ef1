// SPDX-License-Identifier: BSD-3-Clause
// Reads the packets that a video file stores, without decoding them (FFmpeg's libavformat).
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>

extern "C" {
#include <libavformat/avformat.h>
}

namespace rumi {

struct CloseVideoFormat {
  void operator()(AVFormatContext* format) const { avformat_close_input(&format); }
};
using VideoFormat = std::unique_ptr<AVFormatContext, CloseVideoFormat>;
// Opens a file; nullptr if it is no video, or cannot be read.
VideoFormat open_video_format(const std::filesystem::path& file);

class VideoStream {
 public:
  // Returns nullptr if the file has no stream of images of that number, or cannot be read.
  static std::unique_ptr<VideoStream> open(const std::filesystem::path& file, int number);

  // Returns the next packet, valid until the next call; nullptr after the last one.
  const AVPacket* next();

  const AVStream& stream() const { return *format_->streams[index_]; }
  // Returns the length of the file, over all streams, by its own header; 0 if the header does not say.
  int64_t promised_us() const;
  // Returns the latest end of all packets that were read so far, over all streams.
  int64_t end_us() const { return end_us_; }
  // True if the file has no container: FFmpeg then counts its frames at 25 Hz, whatever their rate is.
  bool is_bare() const;

 private:
  struct FreePacket {
    void operator()(AVPacket* packet) const { av_packet_free(&packet); }
  };
  VideoStream(VideoFormat format, int index);

  void note_end();

  VideoFormat format_;
  int index_;
  int64_t end_us_ = 0;
  std::unique_ptr<AVPacket, FreePacket> packet_;
};

// Returns how often pictures must be turned by 90 degrees counter-clockwise to be upright, 0 to 3; phones store that.
int quarter_turns(const AVStream& stream);

// Returns the stored time of a packet or a picture, in the unit of its stream; nullopt if it has none.
std::optional<int64_t> usable_time(int64_t stored);

}  // namespace rumi
