// SPDX-License-Identifier: BSD-3-Clause
#include "formats/video/video_decoder.h"

#include <opencv2/core.hpp>

#include "slam/geometry/max_side.h"

extern "C" {
#include <libavutil/intreadwrite.h>
#include <libavutil/pixdesc.h>
}

namespace rumi {
namespace {

cv::Mat turned(const cv::Mat& pixels, const AVStream& stream) {
  const int quarters = quarter_turns(stream);
  if (quarters == 0) return pixels;
  cv::Mat out;
  cv::rotate(pixels, out,
             quarters == 1   ? cv::ROTATE_90_COUNTERCLOCKWISE
             : quarters == 2 ? cv::ROTATE_180
                             : cv::ROTATE_90_CLOCKWISE);
  return out;
}

bool is_deep_grey(const AVPixFmtDescriptor& format) {
  constexpr uint64_t kOther = AV_PIX_FMT_FLAG_FLOAT | AV_PIX_FMT_FLAG_PAL | AV_PIX_FMT_FLAG_BITSTREAM;
  return format.nb_components == 1 && format.comp[0].depth > 8 && format.comp[0].depth <= 16 &&
         format.comp[0].step == 2 && (format.flags & kOther) == 0;
}

cv::Mat deep_grey(const AVFrame& frame, const AVPixFmtDescriptor& format) {
  cv::Mat out(frame.height, frame.width, CV_16UC1);
  const bool is_big_endian = (format.flags & AV_PIX_FMT_FLAG_BE) != 0;
  for (int y = 0; y < out.rows; ++y) {
    const uint8_t* row = frame.data[0] + static_cast<ptrdiff_t>(y) * frame.linesize[0];
    for (int x = 0; x < out.cols; ++x)
      out.ptr<uint16_t>(y)[x] = static_cast<uint16_t>(is_big_endian ? AV_RB16(row + 2 * x) : AV_RL16(row + 2 * x));
  }
  return out;
}

}  // namespace

VideoDecoder::VideoDecoder(std::unique_ptr<VideoStream> stream, Codec codec)
    : stream_(std::move(stream)), codec_(std::move(codec)), frame_(av_frame_alloc()) {}

std::unique_ptr<VideoDecoder> VideoDecoder::open(const std::filesystem::path& file, int number) {
  std::unique_ptr<VideoStream> stream = VideoStream::open(file, number);
  if (!stream) return nullptr;
  const AVCodec* codec = avcodec_find_decoder(stream->stream().codecpar->codec_id);
  if (!codec) return nullptr;
  Codec context(avcodec_alloc_context3(codec));
  if (!context || avcodec_parameters_to_context(context.get(), stream->stream().codecpar) < 0) return nullptr;
  context->pkt_timebase = stream->stream().time_base;
  context->max_pixels = int64_t{kMaxSide} * kMaxSide;
  if (avcodec_open2(context.get(), codec, nullptr) < 0) return nullptr;
  return std::unique_ptr<VideoDecoder>(new VideoDecoder(std::move(stream), std::move(context)));
}

bool VideoDecoder::next() {
  constexpr int kMostErrors = 64;  // in a row, behind the last packet
  for (int errors = 0; frame_ && errors < kMostErrors;) {
    const int got = avcodec_receive_frame(codec_.get(), frame_.get());
    if (got >= 0) return true;
    if (got == AVERROR_EOF || (is_flushed_ && got == AVERROR(EAGAIN))) return false;
    if (is_flushed_) {
      ++errors;
      continue;
    }
    const AVPacket* packet = stream_->next();
    is_flushed_ = packet == nullptr;
    // A packet that FFmpeg refuses is damaged: the next one may be better.
    avcodec_send_packet(codec_.get(), packet);
  }
  return false;
}

bool VideoDecoder::is_damaged() const {
  return frame_->decode_error_flags != 0 || (frame_->flags & AV_FRAME_FLAG_CORRUPT) != 0;
}

bool VideoDecoder::is_interlaced() const {
#if LIBAVUTIL_VERSION_INT >= AV_VERSION_INT(58, 7, 100)
  return (frame_->flags & AV_FRAME_FLAG_INTERLACED) != 0;
#else
  return frame_->interlaced_frame != 0;
#endif
}

cv::Mat VideoDecoder::pixels(bool colour) {
  const AVPixFmtDescriptor* format = av_pix_fmt_desc_get(static_cast<AVPixelFormat>(frame_->format));
  if (!format || frame_->width < 1 || frame_->height < 1) return {};
  cv::Mat out;
  if (is_deep_grey(*format))
    out = deep_grey(*frame_, *format);
  else if (colour && format->nb_components >= 3)
    out = convert(AV_PIX_FMT_BGR24, CV_8UC3);
  else
    out = convert(AV_PIX_FMT_GRAY8, CV_8UC1);
  return out.empty() ? out : turned(out, stream_->stream());
}

cv::Mat VideoDecoder::convert(AVPixelFormat to, int type) {
  const int width = frame_->width, height = frame_->height;
  scaler_.reset(sws_getCachedContext(scaler_.release(), width, height, static_cast<AVPixelFormat>(frame_->format),
                                     width, height, to, SWS_BICUBIC, nullptr, nullptr, nullptr));
  if (!scaler_) return {};
  // FFmpeg's fast routines write up to the end of a row of 64 bytes.
  constexpr int kAlign = 64;
  cv::Mat out(height, (width + kAlign - 1) / kAlign * kAlign, type);
  uint8_t* const planes[] = {out.data, nullptr, nullptr, nullptr};
  const int rows[] = {static_cast<int>(out.step[0]), 0, 0, 0};
  if (sws_scale(scaler_.get(), frame_->data, frame_->linesize, 0, height, planes, rows) <= 0) return {};
  return out.colRange(0, width);
}

}  // namespace rumi
