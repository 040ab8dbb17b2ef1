// SPDX-License-Identifier: BSD-3-Clause
// Writes videos as cameras and phones do, which OpenCV's writer cannot: with B frames, or without a container.
#pragma once

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <vector>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
}

namespace rumi::testing {

struct VideoOptions {
  int frames = 30;
  int b_frames = 0;
  const char* container = "mp4";  // FFmpeg's name of it; "h264": the bare stream
  AVCodecID codec = AV_CODEC_ID_H264;
  AVPixelFormat pixels = AV_PIX_FMT_YUV420P;  // or GRAY16LE, which begins at 1000 and rises by 100 a frame
  int width = 64, height = 48;
  int step_us = 40'000;                   // time from frame to frame
  int pause_before = 0, pause_steps = 0;  // this frame and those behind it come so many steps later
  bool is_interlaced = false;
  AVRational pixel_shape = {0, 1};  // width to height; 0: the file does not say
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

// Writes pictures that grow brighter, by 5 a frame. Returns false if this FFmpeg cannot.
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
  encoder->gop_size = options.pause_steps > 0 ? 250 : 12;
  encoder->sample_aspect_ratio = options.pixel_shape;
  if (options.is_interlaced) encoder->flags |= AV_CODEC_FLAG_INTERLACED_DCT | AV_CODEC_FLAG_INTERLACED_ME;
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
      packet->duration = 1;  // else MP4 leaves out the last packet
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
    frame->pts = i + (i >= options.pause_before ? options.pause_steps : 0);
#if LIBAVUTIL_VERSION_INT >= AV_VERSION_INT(58, 7, 100)
    if (options.is_interlaced) frame->flags |= AV_FRAME_FLAG_INTERLACED | AV_FRAME_FLAG_TOP_FIELD_FIRST;
#else
    frame->interlaced_frame = frame->top_field_first = options.is_interlaced ? 1 : 0;
#endif
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

// Writes the streams of these videos into one file, packet by packet. Returns false if this FFmpeg cannot.
inline bool join_videos(const std::vector<std::filesystem::path>& videos, const std::filesystem::path& joined) {
  AVFormatContext* out = nullptr;
  if (avformat_alloc_output_context2(&out, nullptr, nullptr, joined.c_str()) < 0) return false;
  std::vector<AVFormatContext*> in(videos.size(), nullptr);
  bool ok = true;
  for (size_t i = 0; ok && i < videos.size(); ++i) {
    ok = avformat_open_input(&in[i], videos[i].c_str(), nullptr, nullptr) >= 0 &&
         avformat_find_stream_info(in[i], nullptr) >= 0;
    AVStream* stream = ok ? avformat_new_stream(out, nullptr) : nullptr;
    ok = stream && avcodec_parameters_copy(stream->codecpar, in[i]->streams[0]->codecpar) >= 0;
    if (ok) stream->codecpar->codec_tag = 0;
    if (ok) stream->time_base = in[i]->streams[0]->time_base;
  }
  ok = ok && avio_open(&out->pb, joined.c_str(), AVIO_FLAG_WRITE) >= 0 && avformat_write_header(out, nullptr) >= 0;
  AVPacket* packet = av_packet_alloc();
  for (size_t i = 0; ok && i < in.size(); ++i)
    while (av_read_frame(in[i], packet) >= 0) {
      av_packet_rescale_ts(packet, in[i]->streams[0]->time_base, out->streams[i]->time_base);
      packet->stream_index = static_cast<int>(i);
      packet->pos = -1;
      ok = ok && av_interleaved_write_frame(out, packet) >= 0;
    }
  ok = ok && av_write_trailer(out) >= 0;
  av_packet_free(&packet);
  for (AVFormatContext*& one : in) avformat_close_input(&one);
  avio_closep(&out->pb);
  avformat_free_context(out);
  return ok;
}

}  // namespace rumi::testing
