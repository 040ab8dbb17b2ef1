// SPDX-License-Identifier: BSD-3-Clause
#include "formats/video/video_choice.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <tuple>

#include "formats/video/video_stream.h"

namespace rumi {
namespace {

// Returns the size of the upright picture.
cv::Size size_of(const AVStream& stream) {
  const cv::Size stored(stream.codecpar->width, stream.codecpar->height);
  return quarter_turns(stream) % 2 == 0 ? stored : cv::Size(stored.height, stored.width);
}

bool is_cover(const AVStream& stream) { return (stream.disposition & AV_DISPOSITION_ATTACHED_PIC) != 0; }

std::string note_on_streams(const std::vector<const AVStream*>& streams, const AVStream& chosen, bool is_wanted) {
  std::vector<std::string> sizes;
  sizes.reserve(streams.size());
  for (const AVStream* stream : streams)
    sizes.push_back(fmt::format("{} x {} (stream {})", size_of(*stream).width, size_of(*stream).height, stream->index));
  return fmt::format(
      "has {} streams of images, {}: stream {} is played, {}; for another one take it out first, such as by "
      "`ffmpeg -i FILE -map 0:NUMBER -c copy OTHER`",
      sizes.size(), fmt::join(sizes, ", "), chosen.index,
      is_wanted ? "which is of the calibration's size" : "because none is larger");
}

// Returns an empty string if pixels are square, or if the file does not say.
std::string note_on_pixels(AVFormatContext* format, AVStream* stream) {
  const AVRational shape = av_guess_sample_aspect_ratio(format, stream, nullptr);
  if (shape.num <= 0 || shape.den <= 0 || shape.num == shape.den) return {};
  return fmt::format(
      "its pixels are not square ({}:{}), and are used as they are stored: the calibration must be of these, with fx "
      "{:.3g} times fy; or make them square, in the video and for the calibration: `ffmpeg -i FILE -vf "
      "scale=iw*sar:ih,setsar=1 OTHER`",
      shape.num, shape.den, static_cast<double>(shape.den) / shape.num);
}

bool is_interlaced(const AVStream& stream) {
  const AVFieldOrder order = stream.codecpar->field_order;
  return order != AV_FIELD_UNKNOWN && order != AV_FIELD_PROGRESSIVE;
}

}  // namespace

VideoChoice choose_video_stream(const std::filesystem::path& file, const std::vector<cv::Size>& wanted) {
  const VideoFormat format = open_video_format(file);
  if (!format) return {};
  const int best = av_find_best_stream(format.get(), AVMEDIA_TYPE_VIDEO, -1, -1, nullptr, 0);
  std::vector<const AVStream*> streams;
  for (unsigned i = 0; i < format->nb_streams; ++i) {
    const AVStream* stream = format->streams[i];
    if (stream->codecpar->codec_type == AVMEDIA_TYPE_VIDEO && !is_cover(*stream)) streams.push_back(stream);
  }
  if (streams.empty() && best < 0) return {};
  if (streams.empty()) streams.push_back(format->streams[best]);
  const auto is_wanted = [&wanted](const AVStream* stream) {
    return std::find(wanted.begin(), wanted.end(), size_of(*stream)) != wanted.end();
  };
  const auto rank = [&](const AVStream* stream) {
    const cv::Size size = size_of(*stream);
    return std::tuple(is_wanted(stream), int64_t{size.width} * size.height, stream->index == best);
  };
  const AVStream* chosen =
      *std::max_element(streams.begin(), streams.end(), [&](auto a, auto b) { return rank(a) < rank(b); });
  VideoChoice choice{chosen->index, is_interlaced(*chosen), {}};
  if (streams.size() > 1) choice.notes.push_back(note_on_streams(streams, *chosen, is_wanted(chosen)));
  if (std::string note = note_on_pixels(format.get(), format->streams[chosen->index]); !note.empty())
    choice.notes.push_back(std::move(note));
  return choice;
}

}  // namespace rumi
