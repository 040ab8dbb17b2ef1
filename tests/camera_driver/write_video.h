// SPDX-License-Identifier: BSD-3-Clause
// Videos as cameras and phones write them, which OpenCV's writer cannot: with B frames, or without a container.
#pragma once

#include <algorithm>
#include <cstring>
#include <filesystem>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
}

namespace rumi::testing {

struct VideoOptions {
  int frames = 30;
  int b_frames = 0;
  const char* container = "mp4";  // as FFmpeg names it; "h264": the bare stream
  AVCodecID codec = AV_CODEC_ID_H264;
  AVPixelFormat pixels = AV_PIX_FMT_YUV420P;  // or GRAY16LE, of 1000 + 100 a frame
  int width = 64, height = 48;
  int step_us = 40'000;  // from frame to frame
};

inline void fill(AVFrame* frame, int i) {
  const bool is_deep = frame->format == AV_PIX_FMT_GRAY16LE;
  for (int plane = 0; plane < (is_deep ? 1 : 3); ++plane) {
    const int rows = plane == 0 ? frame->height : frame->height / 2;
    const int value = plane == 0 ? 40 + 5 * i : 128;
    for (int y = 0; y < rows; ++y) {
      uint8_t* row = frame->data[plane] + static_cast<ptrdiff_t>(y) * frame->linesize[plane];
      if (is_deep)
        std::fill_n(reinterpret_cast<uint16_t*>(row), frame->width, static_cast<uint16_t>(1000 + 100 * i));
      else
        std::memset(row, value, static_cast<size_t>(frame->linesize[plane]));
    }
  }
}

// Of pictures that grow brighter, by 5 a frame. False if this FFmpeg cannot.
inline bool write_video(const std::filesystem::path& file, const VideoOptions& options) {
  av_log_set_level(AV_LOG_QUIET);
  const AVCodec* codec = avcodec_find_encoder(options.codec);
  AVFormatContext* format = nullptr;
  if (!codec || avformat_alloc_output_context2(&format, nullptr, options.container, file.c_str()) < 0) return false;
  AVCodecContext* encoder = avcodec_alloc_context3(codec);
  encoder->width = options.width;
  encoder->height = options.height;
  encoder->pix_fmt = options.pixels;
  encoder->time_base = {options.step_us, 1'000'000};
  encoder->max_b_frames = options.b_frames;
  encoder->gop_size = 12;
  if (format->oformat->flags & AVFMT_GLOBALHEADER) encoder->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
  AVStream* stream = avformat_new_stream(format, nullptr);
  bool ok = avcodec_open2(encoder, codec, nullptr) >= 0 &&
            avcodec_parameters_from_context(stream->codecpar, encoder) >= 0 &&
            avio_open(&format->pb, file.c_str(), AVIO_FLAG_WRITE) >= 0;
  stream->time_base = encoder->time_base;
  ok = ok && avformat_write_header(format, nullptr) >= 0;
  AVPacket* packet = av_packet_alloc();
  const auto drain = [&] {
    while (avcodec_receive_packet(encoder, packet) >= 0) {
      packet->duration = 1;  // else MP4 leaves out the last one
      av_packet_rescale_ts(packet, encoder->time_base, stream->time_base);
      packet->stream_index = stream->index;
      ok = ok && av_write_frame(format, packet) >= 0;
      av_packet_unref(packet);
    }
  };
  AVFrame* frame = av_frame_alloc();
  frame->width = options.width;
  frame->height = options.height;
  frame->format = options.pixels;
  for (int i = 0; ok && i < options.frames; ++i) {
    ok = av_frame_get_buffer(frame, 0) >= 0;
    if (ok) fill(frame, i);
    frame->pts = i;
    ok = ok && avcodec_send_frame(encoder, frame) >= 0;
    drain();
    for (AVBufferRef*& buffer : frame->buf) av_buffer_unref(&buffer);
  }
  ok = ok && avcodec_send_frame(encoder, nullptr) >= 0;
  drain();
  ok = ok && av_write_trailer(format) >= 0;
  av_frame_free(&frame);
  av_packet_free(&packet);
  avcodec_free_context(&encoder);
  avio_closep(&format->pb);
  avformat_free_context(format);
  return ok;
}

}  // namespace rumi::testing
