// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/merging/suspects.h"

#include <iterator>
#include <utility>

#include "base/running/due.h"

namespace rumi::map_server {
namespace {

// A left-out submap that has changed is tried again after this time. A submap that grows changes all the time, and
// every build that throws is wasted work.
constexpr int64_t kDoubtUs = 60'000'000;

bool has(const Suspects::Revisions& revisions, SubmapKey key, int64_t revision) {
  const auto known = revisions.find(key);
  return known != revisions.end() && known->second == revision;
}

}  // namespace

Suspects::Revisions Suspects::choose(const Revisions& all, Scope scope, int64_t now_us) {
  scope_ = scope;
  chosen_.clear();
  new_.clear();
  std::optional<std::set<SubmapKey>> group;
  if (!untried_.empty()) {
    group = std::move(untried_.back());
    untried_.pop_back();
  }
  for (const auto& [key, revision] : all) {
    const bool is_new = !has(good(scope), key, revision);
    if (is_left_out(key, revision, now_us) || (is_new && group && !group->contains(key))) continue;
    doubts_.erase(key);
    chosen_[key] = revision;
    if (is_new) new_.insert(key);
  }
  return chosen_;
}

// Notes the chosen submaps as known to build, also for smaller scopes: a submap with which the whole map was built can
// be welded too.
void Suspects::built() {
  for (int scope = static_cast<int>(scope_); scope >= 0; --scope) good_[scope] = chosen_;
}

bool Suspects::broke_off(const std::set<SubmapKey>& failing, int64_t now_us) {
  for (const SubmapKey& key : new_.size() == 1 ? new_ : failing) doubts_[key] = {chosen_.at(key), now_us};
  if (new_.size() > 1 && failing.empty()) {
    const auto middle = std::next(new_.begin(), static_cast<std::ptrdiff_t>(new_.size() / 2));
    untried_.emplace_back(middle, new_.end());
    untried_.emplace_back(new_.begin(), middle);
  }
  return !new_.empty();
}

std::optional<Suspects::Scope> Suspects::unfinished() const {
  return untried_.empty() ? std::nullopt : std::optional(scope_);
}

bool Suspects::is_left_out(SubmapKey key, int64_t revision, int64_t now_us) const {
  const auto doubt = doubts_.find(key);
  if (doubt == doubts_.end()) return false;
  return doubt->second.revision == revision || !is_due(now_us, doubt->second.since_us, kDoubtUs);
}

bool Suspects::is_done(SubmapKey key, int64_t revision, int64_t now_us) const {
  return has(good_.front(), key, revision) || is_left_out(key, revision, now_us);
}

void Suspects::replaced(SubmapKey key, int64_t revision) {
  for (Revisions& good : good_)
    if (const auto known = good.find(key); known != good.end()) known->second = revision;
}

std::set<SubmapKey> Suspects::left_out() const {
  std::set<SubmapKey> keys;
  for (const auto& [key, doubt] : doubts_) keys.insert(key);
  return keys;
}

}  // namespace rumi::map_server
