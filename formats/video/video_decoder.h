// SPDX-License-Identifier: BSD-3-Clause
// Decodes the pictures of a video, one after the other, with FFmpeg's libavcodec. (OpenCV's reader tells neither when a
// picture is shown nor that its size has changed, and makes 8 bits of 16.)
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>

#include "formats/video/video_stream.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libswscale/swscale.h>
}

namespace rumi {

class VideoDecoder {
 public:
  // Returns nullptr if the file has no such stream (see VideoStream), or this FFmpeg cannot decode it.
  static std::unique_ptr<VideoDecoder> open(const std::filesystem::path& file, int stream);

  // Decodes the next picture, in the order of showing. Returns false after the last one. Packets that cannot be decoded
  // are skipped.
  bool next();

  // True if FFmpeg found the present picture damaged and has guessed a part of it.
  bool is_damaged() const;
  // True if the present picture says that it is interlaced: its rows are of two moments in turn.
  bool is_interlaced() const;
  // Returns the present picture's time of showing, as stored in its packet; nullopt if it has none.
  std::optional<int64_t> stamp() const { return usable_time(frame_->pts); }
  // Returns the time of showing that FFmpeg computes, for files in which only some packets have one; nullopt if it has
  // none either.
  std::optional<int64_t> likely_stamp() const { return usable_time(frame_->best_effort_timestamp); }
  // Returns the present picture, upright. Grey of more than 8 bits gives 16 bits, with the values as stored. Other
  // pictures give 8 bits: BGR if they have colour and `colour` is true, else grey. Empty if pixels of this kind cannot
  // be converted.
  cv::Mat pixels(bool colour);

 private:
  struct FreeCodec {
    void operator()(AVCodecContext* codec) const { avcodec_free_context(&codec); }
  };
  struct FreeFrame {
    void operator()(AVFrame* frame) const { av_frame_free(&frame); }
  };
  struct FreeScaler {
    void operator()(SwsContext* scaler) const { sws_freeContext(scaler); }
  };
  using Codec = std::unique_ptr<AVCodecContext, FreeCodec>;

  VideoDecoder(std::unique_ptr<VideoStream> stream, Codec codec);
  cv::Mat convert(AVPixelFormat to, int type);

  std::unique_ptr<VideoStream> stream_;
  Codec codec_;
  std::unique_ptr<AVFrame, FreeFrame> frame_;
  std::unique_ptr<SwsContext, FreeScaler> scaler_;
  bool is_flushed_ = false;
};

}  // namespace rumi
