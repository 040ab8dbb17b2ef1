// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <map>
#include <set>
#include <span>

#include "bus/transport/bus.h"
#include "bus/transport/log_file.h"
#include "bus/wire/image_codec.h"
#include "bus/wire/image_stream.h"
#include "formats/recording/channel_list.h"
#include "formats/recording/frame_reader.h"
#include "formats/recording/recording_parts.h"
#include "formats/times/odd_times.h"
#include "formats/times/time_unit.h"

namespace rumi {
namespace {

// Bytes of the head of an image_t message, big endian: fingerprint, time, width, height, stride, format, size of its
// data.
constexpr size_t kHashBytes = 8, kTimeBytes = 8, kSizeBytes = 4, kHeadBytes = 36;

int64_t big_endian(std::span<const uint8_t> bytes) {
  uint64_t value = 0;
  for (const uint8_t byte : bytes) value = value << 8 | byte;
  return static_cast<int64_t>(value);
}

bool begins_like_image(std::span<const uint8_t> head) {
  return head.size() == kHeadBytes && big_endian(head.first(kHashBytes)) == image_t::getHash();
}

// Names the channels of the log that have images, and what to do; without images it names the other channels.
std::string advice_on_channels_of(const std::string& file) {
  LogReader log(file);
  std::map<std::string, int64_t> with_images, others;
  do {
    while (const std::optional<LogEvent> event = log.next_head(kHeadBytes))
      ++(begins_like_image(event->data) ? with_images : others)[event->channel];
  } while (!log.error().empty() && log.go_on());
  if (!with_images.empty())
    return advice_on_channels({with_images.begin(), with_images.end()}, with_images.begin()->first);
  const std::string all =
      others.empty() ? "is empty" : fmt::format("has messages on {}", list_of_channels({others.begin(), others.end()}));
  return fmt::format("no channel of it has images (image_t of rumi, libbot or bot_core); it {}", all);
}

class LogFrameReader : public FrameReader {
 public:
  LogFrameReader(std::string file, std::string channel)
      : file_(std::move(file)), channel_(std::move(channel)), log_(file_) {
    read_all();
    leave_out_other_cameras();
    choose_unit();
  }

  const std::vector<int64_t>& utimes() const override { return utimes_; }
  std::string where(size_t frame) const override { return fmt::format("{}: image {}", file_, numbers_[frame]); }
  Result<image_t> load(size_t frame, bool /*colour*/) override {
    log_.seek(positions_[frame]);
    const std::optional<LogEvent> event = log_.next_on(channel_);
    image_t image;
    if (!event || !Bus::decode(event->data, &image)) return Error{"is no image_t message, or broken", where(frame)};
    if (const Result<> checked = check_image(image); !checked) return Error{checked.error_text(), where(frame)};
    if (const std::string& calibration = calibration_of_[cameras_[frame]];
        !calibration.empty() && metadata(image, kCalibrationKey).empty())
      set_metadata(&image, kCalibrationKey, calibration);
    return image;
  }
  Malformed malformed() const override { return malformed_; }
  std::vector<std::string> notes() const override {
    std::vector<std::string> notes = {counter_note_, unit_note_, cameras_note_, damage_};
    std::erase(notes, "");
    return notes;
  }
  int64_t of_other_cameras() const override { return other_cameras_; }
  std::string why_no_times() const override { return why_no_times_; }
  std::optional<int64_t> last_recorded_us() const override { return last_recorded_us_; }
  const std::string& damage() const { return damage_; }

 private:
  void read_all() {
    for (;;) {
      while (const std::optional<LogEvent> event = log_.next_on(channel_, kHeadBytes)) add(*event);
      damage_ = log_.error();
      if (damage_.starts_with(file_ + ": ")) damage_.erase(0, file_.size() + 2);
      const int64_t from = log_.position();
      if (damage_.empty() || !log_.go_on()) break;
      skip_damage(from, log_.position());
    }
    // Counts damage as malformed images: as many as the damaged bytes would have held.
    if (malformed_.count == 0 && damaged_places_ > 0) malformed_.first = first_damage_;
    const auto images = static_cast<int64_t>(positions_.size());
    if (damaged_places_ > 0)
      malformed_.count += std::max(damaged_places_, damaged_bytes_ * images / std::max<int64_t>(1, log_.size_bytes()));
  }

  void skip_damage(int64_t from, int64_t to) {
    if (damaged_places_++ == 0) first_damage_ = fmt::format("{}: {}; it goes on at byte {}", file_, damage_, to);
    damaged_bytes_ += std::max<int64_t>(0, to - from);
  }

  void add(const LogEvent& event) {
    const std::span<const uint8_t> head = event.data;
    const int64_t number = event_++;
    if (!begins_like_image(head)) return add_malformed(number);
    utimes_.push_back(big_endian(head.subspan(kHashBytes, kTimeBytes)));
    numbers_.push_back(number);
    positions_.push_back(log_.position_of_last());
    cameras_.push_back(camera_of_last(head));
    last_recorded_us_ = std::max(last_recorded_us_.value_or(event.utime_us), event.utime_us);
  }

  // Tells cameras apart by the stream and the calibration in the image. An image without them is of the previous
  // camera.
  size_t camera_of_last(std::span<const uint8_t> head) {
    std::vector<uint8_t> message(head.begin(), head.end());
    const auto size = static_cast<uint32_t>(big_endian(head.last(kSizeBytes)));
    std::fill(message.end() - kSizeBytes, message.end(), uint8_t{0});  // the pixels are left out, so their size is 0
    const std::vector<uint8_t> rest = log_.data_of_last(kHeadBytes + size);
    message.insert(message.end(), rest.begin(), rest.end());
    image_t image;
    if (!rest.empty() && !Bus::decode(message, &image)) image = {};
    if (const int64_t stream = stream_of(image); stream != kNoStream) camera_.first = stream;
    if (const std::string_view text = metadata(image, kCalibrationKey); !text.empty()) camera_.second = text;
    const auto [known, is_new] = known_cameras_.try_emplace(camera_, known_cameras_.size());
    if (is_new) calibration_of_.push_back(camera_.second);
    return known->second;
  }

  // If cameras take turns, keeps only the images of the first one: they cannot be played as one recording. A camera
  // that follows another one for good is kept.
  void leave_out_other_cameras() {
    constexpr size_t kMostReturns = 1, kLeastInARow = 10;
    size_t turns = 0;
    for (size_t i = 1; i < cameras_.size(); ++i) turns += cameras_[i] != cameras_[i - 1] ? 1 : 0;
    const std::set<size_t> all(cameras_.begin(), cameras_.end());
    if (turns + 1 - std::min(turns + 1, all.size()) <= kMostReturns || turns * kLeastInARow <= cameras_.size()) return;
    const size_t before = utimes_.size();
    keep_if([this, first = cameras_.front()](size_t i) { return cameras_[i] == first; });
    other_cameras_ = static_cast<int64_t>(before - utimes_.size());
    cameras_note_ = fmt::format("its images are of {} cameras or streams in turn: the {} of the first one are played",
                                all.size(), utimes_.size());
  }

  void keep_if(const std::function<bool(size_t)>& is_kept) {
    size_t kept = 0;
    for (size_t i = 0; i < utimes_.size(); ++i) {
      if (!is_kept(i)) continue;
      utimes_[kept] = utimes_[i];
      numbers_[kept] = numbers_[i];
      cameras_[kept] = cameras_[i];
      positions_[kept++] = positions_[i];
    }
    utimes_.resize(kept);
    cameras_.resize(kept);
    numbers_.resize(kept);
    positions_.resize(kept);
  }

  // Finds the unit of the times, which should be microseconds, and leaves out images without a plausible time.
  void choose_unit() {
    why_no_times_ = why_negative(utimes_);
    if (!why_no_times_.empty()) return std::fill(utimes_.begin(), utimes_.end(), 0);
    std::vector<std::string> texts;
    texts.reserve(utimes_.size());
    for (const int64_t utime : utimes_) texts.push_back(std::to_string(utime));
    counter_note_ = continue_32_bits(&texts);
    const ChosenUnit chosen = choose_time_unit(texts, TimeUnit::kMicroseconds);
    unit_note_ = chosen.note;
    for (size_t i = 0; i < texts.size(); ++i) {
      utimes_[i] = parse_time_us(texts[i], chosen.unit).value_or(-1);
      if (!plausible_utime(utimes_[i])) add_malformed(numbers_[i]);
    }
    keep_if([this](size_t i) { return plausible_utime(utimes_[i]); });
  }
  void add_malformed(int64_t number) {
    if (malformed_.count++ == 0)
      malformed_.first = fmt::format("{}: image {}: is no image_t message, broken, or of no time", file_, number);
  }

  std::string file_, channel_, unit_note_, counter_note_, cameras_note_, why_no_times_;
  std::optional<int64_t> last_recorded_us_;
  std::string damage_;        // the damage in which the log ends; empty if it ends well
  std::string first_damage_;  // the first damage behind which reading went on
  int64_t damaged_places_ = 0, damaged_bytes_ = 0;
  LogReader log_;
  int64_t event_ = 0;                                  // messages on the channel so far
  std::vector<int64_t> utimes_, numbers_, positions_;  // of each frame
  std::vector<size_t> cameras_;                        // of each frame
  std::pair<int64_t, std::string> camera_;             // stream and calibration of the last image
  std::map<std::pair<int64_t, std::string>, size_t> known_cameras_;
  std::vector<std::string> calibration_of_;  // by camera
  int64_t other_cameras_ = 0;
  Malformed malformed_;
};

// Reads one log after the other.
class LogParts : public FrameReader {
 public:
  void add(std::unique_ptr<FrameReader> part) {
    begins_.push_back(utimes_.size());
    utimes_.insert(utimes_.end(), part->utimes().begin(), part->utimes().end());
    for (const std::string& note : part->notes()) add_note(note);
    if (why_no_times_.empty()) why_no_times_ = part->why_no_times();
    const Malformed more = part->malformed();
    if (malformed_.count == 0) malformed_.first = more.first;
    malformed_.count += more.count;
    other_cameras_ += part->of_other_cameras();
    parts_.push_back(std::move(part));
  }
  // Adds a note; one that several parts have is kept once.
  void add_note(const std::string& note) {
    if (std::find(notes_.begin(), notes_.end(), note) == notes_.end()) notes_.push_back(note);
  }

  const std::vector<int64_t>& utimes() const override { return utimes_; }
  std::string why_no_times() const override { return why_no_times_; }
  std::string where(size_t frame) const override {
    const size_t part = part_of(frame);
    return parts_[part]->where(frame - begins_[part]);
  }
  Result<image_t> load(size_t frame, bool colour) override {
    const size_t part = part_of(frame);
    return parts_[part]->load(frame - begins_[part], colour);
  }
  Malformed malformed() const override { return malformed_; }
  int64_t of_other_cameras() const override { return other_cameras_; }
  std::vector<std::string> notes() const override { return notes_; }

 private:
  size_t part_of(size_t frame) const {
    return static_cast<size_t>(std::upper_bound(begins_.begin(), begins_.end(), frame) - begins_.begin()) - 1;
  }

  std::vector<std::unique_ptr<FrameReader>> parts_;
  std::vector<size_t> begins_;  // first frame of each part
  std::vector<int64_t> utimes_;
  std::string why_no_times_;
  Malformed malformed_;
  int64_t other_cameras_ = 0;
  std::vector<std::string> notes_;
};

// Sorts logs by the time of their first message. The numbers in the names give the same order, except after `lcm-logger
// --rotate`, where the newest file has 0.
std::vector<std::filesystem::path> sorted_by_time(std::vector<std::filesystem::path> files) {
  std::stable_sort(files.begin(), files.end(), [](const auto& a, const auto& b) {
    return first_recorded_in_log(a).value_or(0) < first_recorded_in_log(b).value_or(0);
  });
  return files;
}

}  // namespace

OpenedReader open_log(const std::filesystem::path& file, const std::string& channel) {
  auto reader = std::make_unique<LogFrameReader>(file.string(), channel);
  if (reader->utimes().empty() && !reader->damage().empty()) return Error{reader->damage(), file.string()};
  if (!reader->utimes().empty()) return OpenedReader(std::move(reader));
  const std::string others =
      reader->malformed().count > 0 ? fmt::format(", but {} other or broken messages", reader->malformed().count) : "";
  return Error{fmt::format("no image on channel '{}'{}", channel, others), file.string(),
               advice_on_channels_of(file.string())};
}

OpenedReader open_log_parts(const std::vector<std::filesystem::path>& files, const std::string& channel) {
  auto parts = std::make_unique<LogParts>();
  std::vector<PartTimes> times;
  std::optional<Error> first_error;
  for (const std::filesystem::path& file : sorted_by_time(files)) {
    OpenedReader part = open_log(file, channel);
    if (part) {
      times.push_back(
          {file.filename().string(), first_recorded_in_log(file).value_or(0), (*part)->last_recorded_us().value_or(0)});
      parts->add(std::move(*part));
      continue;
    }
    if (!first_error) first_error = part.error();
    parts->add_note(part.error_text());
  }
  if (times.empty()) return *first_error;
  if (const std::string why = why_not_one_recording(times); !why.empty())
    return Error{why, files.front().parent_path().string()};
  parts->add_note(fmt::format("its {} files are played as one recording, in the order of their times", files.size()));
  return OpenedReader(std::move(parts));
}

}  // namespace rumi
