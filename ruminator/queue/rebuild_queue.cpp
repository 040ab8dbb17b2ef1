// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/queue/rebuild_queue.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "base/files/scratch_folder.h"
#include "base/running/due.h"
#include "base/running/failures.h"
#include "base/running/log.h"
#include "base/this_process/process_name.h"
#include "bus/process/process.h"
#include "ruminator/window/window_message.h"

namespace rumi::ruminator {
namespace {

constexpr int64_t kAdoptPeriodUs = 10'000'000;  // looks for jobs whose ruminator has died
constexpr int64_t kStopDeliveryUs = 2'000'000;  // after stop(), time for a submap that is being sent
constexpr double kMaxFrontRotationDeg = 5;      // median difference to a front submap that is warned of

const char* word_of(int8_t state) {
  constexpr const char* kWords[] = {"collecting", "queued", "extracting", "matching", "mapping", "published", "failed"};
  return kWords[std::clamp<int>(state, 0, std::size(kWords) - 1)];
}

std::string describe(const BuildProgress& progress) {
  std::string text = fmt::format("{} {:.0f} %", word_of(window_state(progress.stage)), 100 * progress.fraction);
  if (progress.remaining_s >= 0) text += fmt::format(", about {:.0f} s left", progress.remaining_s);
  return text;
}

std::string describe_result(const RuminationWindow& window, const BuildResult& r) {
  return fmt::format("{} of {} + {} of {} + {} of {} images rebuilt in {:.1f} s ({:.1f} s CPU), {:.2f} px", r.approach,
                     window.approach.size(), r.gap, window.gap.size(), r.departure, window.departure.size(), r.wall_s,
                     r.cpu_s, r.error_px);
}

// The work folder of a job in memory.
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
  return std::find_if(entries_.begin(), entries_.end(), [&](const QueueEntry& e) { return e.name == name; });
}

RebuildQueue::Entries::iterator RebuildQueue::building() {
  return std::find_if(entries_.begin(), entries_.end(), [](const QueueEntry& e) { return e.is<Building>(); });
}

bool RebuildQueue::knows(JobName name) const {
  return std::any_of(entries_.begin(), entries_.end(), [&](const QueueEntry& e) { return e.name == name; });
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

// False if another process works on the window, or has rebuilt it.
bool RebuildQueue::claim(QueueEntry& entry) {
  InSpool* const spooled = entry.spooled();
  if (!spooled || spooled->claim) return true;
  spooled->claim = spool_->claim(entry.name);
  if (spooled->claim && !spool_->is_waiting(entry.name)) spooled->claim.reset();
  return spooled->claim.has_value();
}

void RebuildQueue::start_next(int64_t now_us) {
  auto entry = entries_.begin();
  while (entry != entries_.end() && !worker_.busy() && !stopping_) {
    const auto next = std::next(entry);
    if (entry->is<Waiting>() && entry->is_due(now_us)) {
      if (claim(*entry)) {
        start(entry);
        take_report(now_us);  // at once where there is no thread
      } else {
        entries_.erase(entry);  // if the process that has it dies, adopt() finds it again
      }
    }
    entry = next;
  }
}

// Returns what is wrong, or an empty string.
std::string RebuildQueue::make_task(QueueEntry& entry, BuildTask* task) {
  InMemory* const memory = entry.memory();
  if (!memory) {
    entry.tries = spool_->begin_try(entry.name);
    task->file = spool_->window_file(entry.name);
    task->work_folder = spool_->work_folder(entry.name);
    return {};
  }
  ++entry.tries;
  task->job = memory->job;
  return thrown_by([&] {
    memory->work_folder = temporary_work_folder(entry.name, options_.scratch);
    task->work_folder = memory->work_folder;
  });
}

void RebuildQueue::start(Entries::iterator entry) {
  BuildTask task;
  const std::string problem = make_task(*entry, &task);
  if (!problem.empty()) return fail(entry, problem);
  // A job that ends the process must not do so for ever.
  if (entry->tries > options_.build_tries)
    return fail(entry, fmt::format("rebuilding was begun {} times and never ended", entry->tries - 1));
  {
    const std::scoped_lock lock(progress_mutex_);
    progress_.reset();
  }
  entry->state = Building();
  announce(*entry);
  worker_.start(std::move(task));
}

void RebuildQueue::on_progress(const BuildProgress& progress) {
  {
    const std::scoped_lock lock(progress_mutex_);
    progress_ = progress;
    // The estimate depends on the load of the machine; without a thread, runs must be repeatable.
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
  BuildProgress& last = entry->as<Building>()->progress;
  const bool is_new_stage = progress->stage != last.stage;
  last = *progress;
  if (is_new_stage) announce(*entry);
}

void RebuildQueue::take_report(int64_t now_us) {
  const auto report = worker_.take_report();
  const auto entry = building();
  if (!report || entry == entries_.end()) return;
  entry->state = Waiting();
  on_built(entry, *report, now_us);
}

void RebuildQueue::on_built(Entries::iterator entry, const BuildReport& report, int64_t now_us) {
  const BuildResult& r = report.result;
  std::error_code ignored;
  if (const InMemory* memory = entry->memory()) std::filesystem::remove_all(memory->work_folder, ignored);
  if (r.cancelled && !r.submap) {
    if (entry->spooled()) spool_->forget_try(entry->name);
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
  entry->result = describe_result(entry->window, r) + broken;
  tell(*entry, r);
  ++built_;
  store(*entry, report.submap);
}

void RebuildQueue::tell(const QueueEntry& entry, const BuildResult& r) {
  const int32_t id = entry.window.id;
  log_debug("window {}: {}, {} landmarks{}{}; on its way to map_server", id, entry.result, r.submap->landmarks.size(),
            r.origin.empty() ? "" : ", ", r.origin);
  if (!r.warning.empty()) log_warning("window {}: {}", id, r.warning);
  for (const FrontAgreement& a : r.agreement) {
    // The back submap has passed its own tests, so the front submap is likely to be wrong.
    if (a.rotation_deg > kMaxFrontRotationDeg)
      log_warning("window {}: front submap {} turns otherwise, by {:.1f} degrees in {} frames", id, a.submap_id,
                  a.rotation_deg, a.frames);
  }
}

void RebuildQueue::store(QueueEntry& entry, std::vector<uint8_t> submap) {
  if (entry.is_claimed()) {
    spool_problem_ = spool_->store_submap(entry.name, submap);
    if (spool_problem_.empty())
      submap.clear();
    else
      log_error("{}; the back submap is kept in memory", spool_problem_);
  }
  if (InMemory* memory = entry.memory()) memory->job.reset();
  entry.state = Built{.submap = std::move(submap)};
}

void RebuildQueue::try_again_or_fail(Entries::iterator entry, const std::string& reason, int64_t now_us) {
  if (finishing_ || stopping_ || !options_.build_thread) return give_up(entry, reason);
  if (entry->tries >= options_.build_tries) return fail(entry, reason);
  log_warning("window {}: {}; another try in {:.0f} s", entry->window.id, reason, options_.retry_s);
  entry->state = Waiting{now_us + retry_us()};
  if (InSpool* spooled = entry->spooled()) spooled->claim.reset();
  announce(*entry, reason);
}

void RebuildQueue::fail(Entries::iterator entry, const std::string& reason) {
  std::string kept;
  if (entry->is_claimed()) kept = spool_->fail(entry->name, reason);
  log_warning("window {}: {}: failed{}: {}{}{}", entry->window.id, describe(entry->window),
              entry->build_s > 0 ? fmt::format(" after {:.1f} s", entry->build_s) : "", reason,
              kept.empty() ? "" : "; kept as ", kept);
  publish(*entry, window_t::FAILED, reason);
  ++failed_;
  entries_.erase(entry);
}

// Does not rebuild the window now. If it is in the spool, the next start does.
void RebuildQueue::give_up(Entries::iterator entry, const std::string& reason) {
  InSpool* const spooled = entry->spooled();
  log_info("window {}: not rebuilt, {}{}", entry->window.id, reason,
           spooled ? "; it stays in the spool for the next start" : "");
  if (!spooled) {
    publish(*entry, window_t::FAILED, reason);
    ++failed_;
    entries_.erase(entry);
    return;
  }
  spooled->claim.reset();
  entry->state = LeftForNextStart();
  announce(*entry, reason + "; will be tried again at the next start");
}

// ---- the end

void RebuildQueue::finish() {
  finishing_ = true;
  last_told_us_ = bus_.now_us();
  for (QueueEntry& entry : entries_) {
    if (entry.is<Waiting>()) entry.state = Waiting();
    Built* const built = entry.as<Built>();
    if (!built) continue;
    built->until_us = 0;
    if (!delivery_problem_.empty()) leave_built(entry);  // it was sent without success before
  }
}

void RebuildQueue::stop() {
  const auto lost = std::count_if(entries_.begin(), entries_.end(),
                                  [](const QueueEntry& e) { return e.memory() && e.memory()->job; });
  if (lost > 0) log_warning("{} windows that are in no spool are lost", lost);
  stopping_ = true;
  stopped_us_ = bus_.now_us();
  worker_.cancel();
}

std::string RebuildQueue::waits_for() const {
  if (worker_.busy()) return "a window is being rebuilt";
  if (stopping_ && bus_.now_us() - stopped_us_ >= kStopDeliveryUs) return {};
  for (const QueueEntry& e : entries_) {
    // A window that waits and cannot be claimed belongs to another ruminator.
    if (stopping_ ? !e.is<Sent>() : e.is<LeftForNextStart>()) continue;
    if (e.is<Waiting>()) return fmt::format("window {} is not rebuilt", e.window.id);
    return fmt::format("map_server has not taken the back submap of window {}", e.window.id);
  }
  return {};
}

std::string RebuildQueue::detail() const {
  int queued = 0, built = 0;
  std::string text;
  for (const QueueEntry& e : entries_) {
    const auto* const left = e.as<LeftForNextStart>();
    queued += e.is<Waiting>() || (left && !left->is_built);
    built += e.is<Built>() || e.is<Sent>() || (left && left->is_built);
    if (const auto* b = e.as<Building>()) text += fmt::format("window {} {}; ", e.window.id, describe(b->progress));
  }
  text += fmt::format("{} queued, {} built, {} published, {} failed", queued, built_, published_, failed_);
  if (built > 0) text += fmt::format(", {} back submaps wait for map_server", built);
  if (!delivery_problem_.empty()) text += fmt::format(" ({})", delivery_problem_);
  if (!spool_problem_.empty()) text += "; " + spool_problem_;
  return text;
}

bool RebuildQueue::degraded() const { return !spool_problem_.empty() || !delivery_problem_.empty(); }

}  // namespace rumi::ruminator
