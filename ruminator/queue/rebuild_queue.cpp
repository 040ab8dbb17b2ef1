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

constexpr int64_t kTellPeriodUs = 5'000'000;
constexpr int64_t kStopDeliveryUs = 2'000'000;  // how long after stop() a submap that is being sent is waited for
constexpr double kMaxFrontRotationDeg = 5;      // a larger median difference to a front submap causes a warning

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

// Returns the work folder for a job in memory. `also`: a folder to use if no temporary one can be used.
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
      windows_(bus, options.rebuild ? options.spool : "", options.failed_mb * kBytesPerMb),
      intake_(bus, windows_, options_),
      delivery_(bus, windows_, options.retry_s),
      worker_(std::move(builder), options.build_thread, options.build.nice, [this] { take_progress(); }) {}

void RebuildQueue::add(WindowJob job) {
  if (intake_.add(std::move(job)) && !options_.build_thread) tick(bus_.now_us());
}

void RebuildQueue::refuse(const RuminationWindow& window, const std::string& reason) {
  intake_.refuse(window, reason);
  BuildResult nothing;
  nothing.submap = Error{reason};
  if (built_handler_) built_handler_(window, nothing);
}

void RebuildQueue::tick(int64_t now_us) {
  delivery_.tick(now_us);
  if (!stopping_) intake_.tick(now_us);
  take_progress();
  take_report(now_us);
  start_next(now_us);
  if (!stopping_) delivery_.send_next(now_us);
  windows_.announcer().repeat(windows_.entries(), now_us);
  tell_what_is_left(now_us);
}

// ---- building

void RebuildQueue::start_next(int64_t now_us) {
  QueuedWindows::Entries& entries = windows_.entries();
  auto entry = entries.begin();
  while (entry != entries.end() && !worker_.busy() && !stopping_) {
    const auto next = std::next(entry);
    if (entry->is<Waiting>() && entry->is_due(now_us)) {
      if (windows_.claim(*entry)) {
        start(entry);
        take_report(now_us);  // the report is there at once if the worker has no thread
      } else {
        entries.erase(entry);  // if the process that has claimed it dies, Intake finds it again
      }
    }
    entry = next;
  }
}

Result<BuildTask> RebuildQueue::make_task(QueueEntry& entry) {
  InMemory* const memory = entry.memory();
  if (!memory) {
    Spool& spool = *windows_.spool();
    entry.tries = spool.begin_try(entry.name);
    return BuildTask{nullptr, spool.window_file(entry.name), spool.work_folder(entry.name)};
  }
  ++entry.tries;
  const std::string thrown =
      thrown_by([&] { memory->work_folder = temporary_work_folder(entry.name, options_.scratch); });
  if (!thrown.empty()) return Error{thrown};
  return BuildTask{memory->job, "", memory->work_folder};
}

void RebuildQueue::start(Entry entry) {
  Result<BuildTask> task = make_task(*entry);
  if (!task) return windows_.fail(entry, task.error_text());
  // A job that makes the process crash must not do so again and again.
  if (entry->tries > options_.build_tries)
    return windows_.fail(entry, fmt::format("rebuilding was begun {} times and never ended", entry->tries - 1));
  entry->state = Building();
  windows_.announcer().announce(*entry);
  worker_.start(std::move(*task));
}

void RebuildQueue::take_progress() {
  const std::optional<BuildProgress> progress = worker_.take_progress();
  const auto entry = windows_.building();
  if (!progress || entry == windows_.entries().end()) return;
  BuildProgress& last = entry->as<Building>()->progress;
  const bool is_new_stage = progress->stage != last.stage;
  last = *progress;
  if (is_new_stage) windows_.announcer().announce(*entry);
}

void RebuildQueue::take_report(int64_t now_us) {
  const auto report = worker_.take_report();
  const auto entry = windows_.building();
  if (!report || entry == windows_.entries().end()) return;
  entry->state = Waiting();
  on_built(entry, *report, now_us);
}

void RebuildQueue::on_built(Entry entry, const BuildReport& report, int64_t now_us) {
  const BuildResult& r = report.result;
  std::error_code ignored;
  if (const InMemory* memory = entry->memory()) std::filesystem::remove_all(memory->work_folder, ignored);
  if (r.cancelled && !r.submap) {
    if (entry->spooled()) windows_.spool()->forget_try(entry->name);
    return give_up(entry, "called off");
  }
  entry->build_s += r.wall_s;
  if (built_handler_) built_handler_(entry->window, r);
  const std::string broken =
      report.broken_images > 0 ? fmt::format(" ({} broken images left out)", report.broken_images) : "";
  if (!r.submap) {
    const std::string reason = r.submap.error_text() + broken;
    return r.retryable ? try_again_or_fail(entry, reason, now_us) : windows_.fail(entry, reason);
  }
  entry->result = describe_result(entry->window, r) + broken;
  tell(*entry, r);
  ++built_;
  delivery_.store(*entry, report.submap);
}

void RebuildQueue::tell(const QueueEntry& entry, const BuildResult& r) {
  const int32_t id = entry.window.id;
  log_debug("window {}: {}, {} landmarks{}{}; on its way to map_server", id, entry.result, r.submap->landmarks.size(),
            r.origin.empty() ? "" : ", ", r.origin);
  if (!r.warning.empty()) log_warning("window {}: {}", id, r.warning);
  for (const FrontAgreement& a : r.agreement) {
    // The back submap has passed all tests, so the front submap is probably wrong.
    if (a.rotation_deg > kMaxFrontRotationDeg)
      log_warning("window {}: front submap {} turns otherwise, by {:.1f} degrees in {} frames", id, a.submap_id,
                  a.rotation_deg, a.frames);
  }
}

void RebuildQueue::try_again_or_fail(Entry entry, const std::string& reason, int64_t now_us) {
  if (finishing_ || stopping_ || !options_.build_thread) return give_up(entry, reason);
  if (entry->tries >= options_.build_tries) return windows_.fail(entry, reason);
  log_warning("window {}: {}; another try in {:.0f} s", entry->window.id, reason, options_.retry_s);
  entry->state = Waiting{now_us + static_cast<int64_t>(options_.retry_s * 1e6)};
  if (InSpool* spooled = entry->spooled()) spooled->claim.reset();
  windows_.announcer().announce(*entry, reason);
}

// Leaves the window to the next start if it is in the spool; otherwise announces that it failed, and removes it.
void RebuildQueue::give_up(Entry entry, const std::string& reason) {
  InSpool* const spooled = entry->spooled();
  log_info("window {}: not rebuilt, {}{}", entry->window.id, reason,
           spooled ? "; it stays in the spool for the next start" : "");
  if (!spooled) {
    windows_.announce_failure(*entry, reason);
    windows_.entries().erase(entry);
    return;
  }
  spooled->claim.reset();
  entry->state = LeftForNextStart();
  windows_.announcer().announce(*entry, reason + "; will be tried again at the next start");
}

// ---- the end

void RebuildQueue::finish() {
  finishing_ = true;
  last_told_us_ = bus_.now_us();
  for (QueueEntry& entry : windows_.entries())
    if (entry.is<Waiting>()) entry.state = Waiting();
  delivery_.finish();
}

void RebuildQueue::stop() {
  const QueuedWindows::Entries& entries = windows_.entries();
  const auto lost =
      std::count_if(entries.begin(), entries.end(), [](const QueueEntry& e) { return e.memory() && e.memory()->job; });
  if (lost > 0) log_warning("{} windows that are in no spool are lost", lost);
  stopping_ = true;
  stopped_us_ = bus_.now_us();
  worker_.cancel();
}

std::string RebuildQueue::waits_for() const {
  if (worker_.busy()) return "a window is being rebuilt";
  if (stopping_ && bus_.now_us() - stopped_us_ >= kStopDeliveryUs) return {};
  for (const QueueEntry& e : windows_.entries()) {
    // Passes over the windows that this process will not finish.
    if (stopping_ ? !e.is<Sent>() : e.is<LeftForNextStart>()) continue;
    if (e.is<Waiting>()) return fmt::format("window {} is not rebuilt", e.window.id);
    return fmt::format("map_server has not taken the back submap of window {}", e.window.id);
  }
  return {};
}

std::string RebuildQueue::detail() const {
  int queued = 0, built = 0;
  std::string text;
  for (const QueueEntry& e : windows_.entries()) {
    const auto* const left = e.as<LeftForNextStart>();
    queued += e.is<Waiting>() || (left && !left->is_built);
    built += e.is<Built>() || e.is<Sent>() || (left && left->is_built);
    if (const auto* b = e.as<Building>()) text += fmt::format("window {} {}; ", e.window.id, describe(b->progress));
  }
  text += fmt::format("{} queued, {} built, {} published, {} failed", queued, built_, delivery_.published(),
                      windows_.failed());
  if (built > 0) text += fmt::format(", {} back submaps wait for map_server", built);
  if (!delivery_.problem().empty()) text += fmt::format(" ({})", delivery_.problem());
  if (!windows_.spool_problem().empty()) text += "; " + windows_.spool_problem();
  return text;
}

// Logs now and then what is left to do after finish().
void RebuildQueue::tell_what_is_left(int64_t now_us) {
  if (!finishing_ || finished() || !is_due(now_us, last_told_us_, kTellPeriodUs)) return;
  last_told_us_ = now_us;
  log_info("{}", detail());
}

}  // namespace rumi::ruminator
