// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/queue/rebuild_queue.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "base/due.h"
#include "base/failures.h"
#include "base/log.h"
#include "base/process_name.h"
#include "base/scratch_folder.h"
#include "bus/process/process.h"
#include "bus/wire/why_undecodable.h"
#include "lcmtypes/rumi/submap_update_t.hpp"
#include "ruminator/window/window_message.h"

namespace rumi::ruminator {
namespace {

constexpr int64_t kAnnouncePeriodUs = 1'000'000;
constexpr int64_t kAdoptPeriodUs = 10'000'000;  // looks for jobs whose ruminator has died
constexpr int64_t kTellPeriodUs = 5'000'000;    // what is left to do, while somebody waits for it
constexpr int64_t kStopDeliveryUs = 2'000'000;  // so long a submap under way may still arrive
constexpr int64_t kBytesPerMb = 1'000'000;
constexpr double kMaxFrontRotationDeg = 5;  // median difference to a front submap; beyond it that submap is warned of

int8_t state_of(BuildStage stage) {
  switch (stage) {
    case BuildStage::kExtracting:
      return window_t::EXTRACTING;
    case BuildStage::kMatching:
      return window_t::MATCHING;
    case BuildStage::kMapping:
      return window_t::MAPPING;
  }
  return window_t::MAPPING;
}

const char* word_of(int8_t state) {
  constexpr const char* kWords[] = {"collecting", "queued", "extracting", "matching", "mapping", "published", "failed"};
  return kWords[std::clamp<int>(state, 0, std::size(kWords) - 1)];
}

int64_t image_bytes(const WindowJob& job) {
  int64_t bytes = 0;
  for (const image_t& image : job.images) bytes += static_cast<int64_t>(image.data.size());
  return bytes;
}

std::string describe(const BuildProgress& progress) {
  std::string text = fmt::format("{} {:.0f} %", word_of(state_of(progress.stage)), 100 * progress.fraction);
  if (progress.remaining_s >= 0) text += fmt::format(", about {:.0f} s left", progress.remaining_s);
  return text;
}

std::string describe_result(const RuminationWindow& window, const BuildResult& r) {
  return fmt::format("{} of {} + {} of {} + {} of {} images rebuilt in {:.1f} s ({:.1f} s CPU), {:.2f} px", r.approach,
                     window.approach.size(), r.gap, window.gap.size(), r.departure, window.departure.size(), r.wall_s,
                     r.cpu_s, r.error_px);
}

// Also when the clock was set back by far.
bool may_begin(int64_t now_us, int64_t not_before_us) {
  constexpr int64_t kClockWentBackUs = 3'600'000'000;
  return now_us >= not_before_us || not_before_us - now_us > kClockWentBackUs;
}

// For jobs that are in memory.
std::string temporary_work_folder(JobName name, const std::string& also) {
  return (std::filesystem::path(scratch_folder(also)) /
          fmt::format("rumi-{}-{}", unique_process_name("ruminator"), to_string(name)))
      .string();
}

}  // namespace

RebuildQueue::RebuildQueue(Bus& bus, const RebuildQueueOptions& options, Builder builder, BuiltHandler on_built)
    : bus_(bus),
      options_(options),
      built_handler_(std::move(on_built)),
      sender_(bus, channels::kSubmap, channels::kSubmapAck, unique_process_name("ruminator")),
      worker_(std::move(builder), options.build_thread, options.build.nice,
              [this](const BuildProgress& progress) { on_progress(progress); }) {
  if (options.spool.empty() || !options.rebuild) return;
  spool_ = Spool::open(options.spool, options.failed_mb * kBytesPerMb, &spool_problem_);
  if (spool_)
    adopt();
  else
    log_error("{}; windows are kept in memory", spool_problem_);
}

RebuildQueue::Entries::iterator RebuildQueue::find(JobName name) {
  return std::find_if(entries_.begin(), entries_.end(), [&](const Entry& e) { return e.name == name; });
}

RebuildQueue::Entries::iterator RebuildQueue::building() {
  return std::find_if(entries_.begin(), entries_.end(), [](const Entry& e) { return e.stage == Stage::kBuilding; });
}

bool RebuildQueue::knows(JobName name) const {
  return std::any_of(entries_.begin(), entries_.end(), [&](const Entry& e) { return e.name == name; });
}

// ---- in

void RebuildQueue::adopt() {
  last_adopted_us_ = bus_.now_us();
  for (const JobName name : spool_->built())
    if (!knows(name)) adopt_submap(name);
  for (const JobName name : spool_->waiting())
    if (!knows(name)) adopt_window(name);
}

void RebuildQueue::adopt_submap(JobName name) {
  std::optional<Spool::Claim> claim = spool_->claim(name);
  if (!claim || !spool_->is_built(name)) return;
  Entry entry;
  entry.name = name;
  entry.window.session = name.session;
  entry.window.id = name.window_id;
  entry.stage = Stage::kDelivering;
  entry.announced = window_t::MAPPING;
  entry.claim = std::move(claim);
  entry.result = "rebuilt by an earlier ruminator, left in the spool";
  entries_.push_back(std::move(entry));
}

void RebuildQueue::adopt_window(JobName name) {
  std::optional<Spool::Claim> claim = spool_->claim(name);
  if (!claim || !spool_->is_waiting(name)) return;
  const WindowJobFile file = read_window_manifest(spool_->window_file(name));
  Entry entry;
  entry.name = name;
  entry.window = file.job.window;
  entry.window.session = name.session;
  entry.window.id = name.window_id;
  entries_.push_back(std::move(entry));
  if (!file.ok()) {
    entries_.back().claim = std::move(claim);
    return fail(std::prev(entries_.end()), file.error);
  }
  if (name_of(file.job.window) != name) {
    entries_.back().claim = std::move(claim);
    return fail(std::prev(entries_.end()),
                fmt::format("the file holds window {} of session {}", file.job.window.id, file.job.window.session));
  }
  log_info("window {}: {}, left in the spool, queued", to_string(name), describe(file.job.window));
  announce(entries_.back(), window_t::QUEUED);
}

void RebuildQueue::add(WindowJob job) {
  Entry entry;
  entry.name = name_of(job.window);
  entry.window = job.window;
  Spool::Added added = Spool::Added::kFailed;
  std::string error;
  if (spool_) {
    added = spool_->add(job, &error);
    if (added == Spool::Added::kKnown) {
      log_warning("window {} is in the spool already: another ruminator shares it", to_string(entry.name));
      return;
    }
    if (error != spool_problem_ && !error.empty()) log_error("{}; the window is kept in memory", error);
    spool_problem_ = error;
  }
  // Where there is no thread, time stands still while a window is rebuilt.
  const int64_t resumed_utime_us = entry.window.resumed_utime_us;
  if (options_.build_thread && resumed_utime_us > 0 && frame_utime_us_ >= resumed_utime_us)
    entry.resumed_us = bus_.now_us() - (frame_utime_us_ - resumed_utime_us);
  if (added != Spool::Added::kAdded) entry.job = std::make_shared<const WindowJob>(std::move(job));
  log_debug("window {}: {}{}{}, queued", entry.window.id, describe(entry.window),
            entry.window.reason.empty() ? "" : ", ", entry.window.reason);
  entries_.push_back(std::move(entry));
  announce(entries_.back(), window_t::QUEUED);
  limit();
  if (!options_.build_thread) tick(bus_.now_us());
}

void RebuildQueue::refuse(const RuminationWindow& window, const std::string& reason) {
  Entry entry;
  entry.name = name_of(window);
  entry.window = window;
  log_warning("window {}: {}; failed: {}", window.id, describe(window), reason);
  announce(entry, window_t::FAILED, reason);
  ++failed_;
  BuildResult nothing;
  nothing.failure = reason;
  if (built_handler_) built_handler_(window, nothing);
}

// The newest loss matters most: what waited longest goes first.
void RebuildQueue::limit() {
  const auto waits = [](const Entry& e) { return e.stage == Stage::kQueued && !e.given_up; };
  const auto fills_memory = [](const Entry& e) { return e.stage == Stage::kDelivering && !e.submap.empty(); };
  while (true) {
    int64_t bytes = 0;
    for (const Entry& e : entries_) bytes += e.job ? image_bytes(*e.job) : 0;
    const auto waiting = std::count_if(entries_.begin(), entries_.end(), waits);
    const bool is_large = waiting > 1 && bytes > options_.ring_mb * kBytesPerMb;
    if (waiting > options_.max_queued_windows || is_large) {
      drop(std::find_if(entries_.begin(), entries_.end(),
                        [&](const Entry& e) { return waits(e) && (e.job || !is_large); }),
           fmt::format("dropped before it was rebuilt: {} windows wait", waiting));
    } else if (std::count_if(entries_.begin(), entries_.end(), fills_memory) > options_.max_queued_windows) {
      drop(std::find_if(entries_.begin(), entries_.end(), fills_memory), "map_server does not take its back submap");
    } else {
      return;
    }
  }
}

void RebuildQueue::drop(Entries::iterator entry, const std::string& reason) {
  if (claim(*entry))
    fail(entry, reason);
  else
    entries_.erase(entry);  // it is somebody else's now
}

// ---- building

void RebuildQueue::tick(int64_t now_us) {
  sender_.tick(now_us);
  if (spool_ && !stopping_ && is_due(now_us, last_adopted_us_, kAdoptPeriodUs)) adopt();
  take_progress();
  take_report(now_us);
  start_next(now_us);
  deliver(now_us);
  announce_all(now_us);
}

// False if somebody else works on it, or has.
bool RebuildQueue::claim(Entry& entry) {
  if (entry.job || entry.claim || !spool_) return true;
  entry.claim = spool_->claim(entry.name);
  if (entry.claim && !spool_->is_waiting(entry.name)) entry.claim.reset();
  return entry.claim.has_value();
}

void RebuildQueue::start_next(int64_t now_us) {
  auto entry = entries_.begin();
  while (entry != entries_.end() && !worker_.busy() && !stopping_) {
    const auto next = std::next(entry);
    if (entry->stage == Stage::kQueued && !entry->given_up && may_begin(now_us, entry->not_before_us)) {
      if (claim(*entry)) {
        start(entry);
        take_report(now_us);  // at once where there is no thread
      } else {
        entries_.erase(entry);  // adopt() finds it again, should whoever has it die
      }
    }
    entry = next;
  }
}

void RebuildQueue::start(Entries::iterator entry) {
  BuildTask task;
  if (entry->job) {
    ++entry->tries;
    task.job = entry->job;
    const std::string problem =
        thrown_by([&] { entry->work_folder = temporary_work_folder(entry->name, options_.scratch); });
    if (!problem.empty()) return fail(entry, problem);
    task.work_folder = entry->work_folder;
  } else {
    entry->tries = spool_->begin_try(entry->name);
    task.file = spool_->window_file(entry->name);
    task.work_folder = spool_->work_folder(entry->name);
  }
  // A job that ended the process again and again would do so for ever.
  if (entry->tries > options_.build_tries)
    return fail(entry, fmt::format("rebuilding was begun {} times and never ended", entry->tries - 1));
  entry->stage = Stage::kBuilding;
  entry->note.clear();
  {
    const std::scoped_lock lock(progress_mutex_);
    progress_.reset();
  }
  last_progress_ = {};
  announce(*entry, window_t::EXTRACTING);
  worker_.start(std::move(task));
}

void RebuildQueue::on_progress(const BuildProgress& progress) {
  {
    const std::scoped_lock lock(progress_mutex_);
    progress_ = progress;
    // An estimate depends on how busy the machine is: where there is no thread, all must be repeatable.
    if (!options_.build_thread) progress_->remaining_s = -1;
  }
  if (!options_.build_thread) take_progress();
}

void RebuildQueue::take_progress() {
  std::optional<BuildProgress> progress;
  {
    const std::scoped_lock lock(progress_mutex_);
    progress = std::exchange(progress_, std::nullopt);
  }
  const auto entry = building();
  if (!progress || entry == entries_.end()) return;
  const bool is_new_stage = progress->stage != last_progress_.stage;
  last_progress_ = *progress;
  if (is_new_stage) announce(*entry, state_of(progress->stage));
}

void RebuildQueue::take_report(int64_t now_us) {
  const auto report = worker_.take_report();
  const auto entry = building();
  if (!report || entry == entries_.end()) return;
  entry->stage = Stage::kQueued;
  on_built(entry, *report, now_us);
}

void RebuildQueue::on_built(Entries::iterator entry, const BuildReport& report, int64_t now_us) {
  const BuildResult& r = report.result;
  std::error_code ignored;
  if (entry->job) std::filesystem::remove_all(entry->work_folder, ignored);
  if (r.cancelled && !r.submap) {
    if (!entry->job) spool_->forget_try(entry->name);
    return give_up(entry, "called off");
  }
  entry->build_s += r.wall_s;
  if (built_handler_) built_handler_(entry->window, r);
  if (!report.unreadable.empty()) return fail(entry, report.unreadable);
  const std::string broken =
      report.broken_images > 0 ? fmt::format(" ({} broken images left out)", report.broken_images) : "";
  if (report.submap.empty()) {
    const std::string reason = (r.failure.empty() ? "rebuilding gave nothing, and no reason" : r.failure) + broken;
    return r.retryable ? try_again_or_fail(entry, reason, now_us) : fail(entry, reason);
  }
  const RuminationWindow& w = entry->window;
  entry->result = describe_result(w, r) + broken;
  log_debug("window {}: {}, {} landmarks{}{}; on its way to map_server", w.id, entry->result,
            r.submap->landmarks.size(), r.origin.empty() ? "" : ", ", r.origin);
  if (!r.warning.empty()) log_warning("window {}: {}", w.id, r.warning);
  for (const FrontAgreement& a : r.agreement) {
    // The back submap has passed its own tests: it is the front's that is likely to be wrong.
    if (a.rotation_deg > kMaxFrontRotationDeg)
      log_warning("window {}: front submap {} turns otherwise, by {:.1f} degrees in {} frames", w.id, a.submap_id,
                  a.rotation_deg, a.frames);
  }
  ++built_;
  store(entry, report.submap);
}

void RebuildQueue::store(Entries::iterator entry, std::vector<uint8_t> submap) {
  if (entry->claim) {
    spool_problem_ = spool_->store_submap(entry->name, submap);
    if (spool_problem_.empty())
      submap.clear();
    else
      log_error("{}; the back submap is kept in memory", spool_problem_);
  }
  entry->job.reset();
  entry->stage = Stage::kDelivering;
  entry->submap = std::move(submap);
  entry->not_before_us = 0;
  last_progress_ = {BuildStage::kMapping, 1, -1};
}

void RebuildQueue::try_again_or_fail(Entries::iterator entry, const std::string& reason, int64_t now_us) {
  if (finishing_ || stopping_ || !options_.build_thread) return give_up(entry, reason);
  if (entry->tries >= options_.build_tries) return fail(entry, reason);
  log_warning("window {}: {}; another try in {:.0f} s", entry->window.id, reason, options_.retry_s);
  entry->not_before_us = now_us + retry_us();
  entry->claim.reset();
  announce(*entry, window_t::QUEUED, reason);
}

// ---- out

void RebuildQueue::fail(Entries::iterator entry, const std::string& reason) {
  std::string kept;
  if (entry->claim) kept = spool_->fail(entry->name, reason);
  log_warning("window {}: {}: failed{}: {}{}{}", entry->window.id, describe(entry->window),
              entry->build_s > 0 ? fmt::format(" after {:.1f} s", entry->build_s) : "", reason,
              kept.empty() ? "" : "; kept as ", kept);
  announce(*entry, window_t::FAILED, reason);
  ++failed_;
  entries_.erase(entry);
}

// Not now, but at the next start if it is in the spool.
void RebuildQueue::give_up(Entries::iterator entry, const std::string& reason) {
  const bool is_kept = !entry->job;
  log_info("window {}: not rebuilt, {}{}", entry->window.id, reason,
           is_kept ? "; it stays in the spool for the next start" : "");
  if (is_kept)
    announce(*entry, window_t::QUEUED, reason + "; will be tried again at the next start");
  else
    announce(*entry, window_t::FAILED, reason);
  if (!is_kept) {
    ++failed_;
    entries_.erase(entry);
    return;
  }
  entry->claim.reset();
  entry->given_up = true;
}

void RebuildQueue::deliver(int64_t now_us) {
  const bool under_way = std::any_of(entries_.begin(), entries_.end(), [](const Entry& e) { return e.in_flight; });
  if (under_way || stopping_) return;
  const auto entry = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& e) {
    return e.stage == Stage::kDelivering && !e.given_up && may_begin(now_us, e.not_before_us);
  });
  if (entry == entries_.end()) return;
  std::vector<uint8_t> submap = entry->submap;
  std::string problem;
  if (submap.empty()) problem = spool_->read_submap(entry->name, &submap);
  submap_update_t update;
  if (problem.empty() && !Bus::decode(submap, &update))
    problem = fmt::format("its back submap cannot be sent: {}", why_undecodable<submap_update_t>(submap));
  if (problem.empty())
    send(entry, std::move(submap));
  else
    fail(entry, problem);
}

void RebuildQueue::send(Entries::iterator entry, std::vector<uint8_t> submap) {
  entry->in_flight = true;
  if (entry->note.empty()) announce(*entry, window_t::MAPPING, "built, on its way to map_server");
  sender_.send("", chunk_t::SUBMAP_UPDATE, 0, std::move(submap),
               [this, name = entry->name](const TransferResult& result) { on_delivered(name, result); });
}

void RebuildQueue::on_delivered(JobName name, const TransferResult& result) {
  const auto entry = find(name);
  if (entry == entries_.end()) return;
  entry->in_flight = false;
  delivery_problem_ = result.ok ? "" : result.reason;
  if (!result.ok) {
    const bool is_new = entry->note != result.reason;
    if (is_new) log_warning("window {}: map_server did not take its back submap: {}", name.window_id, result.reason);
    entry->given_up = finishing_;
    entry->not_before_us = bus_.now_us() + retry_us();
    return announce(*entry, window_t::MAPPING, result.reason);
  }
  if (entry->claim)
    if (const std::string error = spool_->complete(name); !error.empty()) log_error("{}", error);
  const std::optional<int64_t> resumed_us = entry->resumed_us;
  log_info("window {}: {}: map_server has it as submap {}{}", name.window_id, entry->result, -name.window_id,
           resumed_us ? fmt::format(", {:.1f} s after tracking resumed",
                                    1e-6 * static_cast<double>(bus_.now_us() - *resumed_us))
                      : "");
  announce(*entry, window_t::PUBLISHED);
  ++published_;
  entries_.erase(entry);
}

void RebuildQueue::announce(Entry& entry, int8_t state, const std::string& reason) {
  entry.announced = state;
  entry.note = reason;
  entry.announced_us = bus_.now_us();
  window_t message = to_message(entry.window, std::max(frame_utime_us_, entry.window.lost_utime_us), state);
  if (!reason.empty()) message.reason = reason;
  if (entry.stage == Stage::kDelivering) {
    message.progress = 1;
  } else if (entry.stage == Stage::kBuilding) {
    message.progress = static_cast<float>(last_progress_.fraction);
    message.remaining_s = static_cast<float>(last_progress_.remaining_s);
  }
  bus_.publish(channels::kWindow, message);
}

void RebuildQueue::announce_all(int64_t now_us) {
  for (Entry& entry : entries_) {
    if (!entry.given_up && is_due(now_us, entry.announced_us, kAnnouncePeriodUs))
      announce(entry, entry.announced, entry.note);
  }
  if (!finishing_ || entries_.empty()) return;
  if (!is_due(now_us, last_told_us_, kTellPeriodUs)) return;
  last_told_us_ = now_us;
  if (!finished()) log_info("{}", detail());
}

// ---- the end

void RebuildQueue::finish() {
  finishing_ = true;
  last_told_us_ = bus_.now_us();
  for (Entry& entry : entries_) {
    entry.not_before_us = 0;
    // It was sent without success before.
    if (entry.stage == Stage::kDelivering && !entry.in_flight && !delivery_problem_.empty()) entry.given_up = true;
  }
}

void RebuildQueue::stop() {
  const auto lost = std::count_if(entries_.begin(), entries_.end(), [](const Entry& e) { return !!e.job; });
  if (lost > 0) log_warning("{} windows that are in no spool are lost", lost);
  stopping_ = true;
  stopped_us_ = bus_.now_us();
  worker_.cancel();
}

std::string RebuildQueue::waits_for() const {
  if (worker_.busy()) return "a window is being rebuilt";
  if (stopping_ && bus_.now_us() - stopped_us_ >= kStopDeliveryUs) return {};
  for (const Entry& e : entries_) {
    // What waits and is not claimable is another ruminator's.
    if (stopping_ ? !e.in_flight : e.given_up) continue;
    if (e.stage != Stage::kDelivering) return fmt::format("window {} is not rebuilt", e.window.id);
    return fmt::format("map_server has not taken the back submap of window {}", e.window.id);
  }
  return {};
}

std::string RebuildQueue::detail() const {
  const auto count = [this](Stage stage) {
    return std::count_if(entries_.begin(), entries_.end(), [&](const Entry& e) { return e.stage == stage; });
  };
  std::string text;
  for (const Entry& e : entries_)
    if (e.stage == Stage::kBuilding) text += fmt::format("window {} {}; ", e.window.id, describe(last_progress_));
  text +=
      fmt::format("{} queued, {} built, {} published, {} failed", count(Stage::kQueued), built_, published_, failed_);
  const auto sending = count(Stage::kDelivering);
  if (sending > 0) text += fmt::format(", {} back submaps wait for map_server", sending);
  if (!delivery_problem_.empty()) text += fmt::format(" ({})", delivery_problem_);
  if (!spool_problem_.empty()) text += "; " + spool_problem_;
  return text;
}

bool RebuildQueue::degraded() const { return !spool_problem_.empty() || !delivery_problem_.empty(); }

}  // namespace rumi::ruminator
