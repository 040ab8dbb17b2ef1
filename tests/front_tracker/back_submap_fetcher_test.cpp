// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/back_submap_fetcher.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "bus/transport/memory_bus.h"
#include "bus/wire/pose.h"
#include "bus/wire/submap_update.h"
#include "lcmtypes/rumi/map_request_t.hpp"
#include "tests/front_tracker/feature_scene.h"

namespace rumi::front_tracker {
namespace {

constexpr int64_t kSession = 7;

// A fetcher on a bus, with a stand-in for map_server.
class BackSubmapFetcherTest : public testing::Test {
 protected:
  BackSubmapFetcherTest()
      : sender_(bus_, channels::kMapChunk, channels::kMapAck, "server"),
        fetcher_(bus_, "front", 100,
                 {.take = [this](const Submap& submap) -> Result<> {
                    if (!refusal_.empty()) return Error{refusal_};
                    taken_.push_back(submap.key.id);
                    return {};
                  },
                  .forget = [this](int id) { forgotten_.push_back(id); }}) {
    bus_.subscribe<map_request_t>(channels::kMapRequest, {}, [this](const map_request_t& r) { on_request(r); });
    for (int id : {-1, -2, -3}) {
      FeatureScene scene(static_cast<unsigned>(-id));
      Submap& submap = submaps_[id] =
          scene.submap({SyntheticScene::pose(0, 0, 0), SyntheticScene::pose(0.2, 0, 0)})->map;
      submap.key = {kSession, id};
      submap.kind = SubmapKind::kBack;
      submap.closed = true;
    }
    fetcher_.begin_session(kSession);
    bus_.set_now_us(1'000'000);
  }

  void on_request(const map_request_t& request) {
    requests_.push_back(request);
    if (silent_) return;
    if (busy_) {
      const std::string why = "busy";
      sender_.send(request.requester, chunk_t::REFUSED, request.request_id, {why.begin(), why.end()}, {});
      return;
    }
    std::vector<uint8_t> bytes = encode_message(answer(request));
    if (cut_ > 0) bytes.resize(bytes.size() / static_cast<size_t>(cut_));
    sender_.send(request.requester, chunk_t::SUBMAP_UPDATE, request.request_id, std::move(bytes),
                 [this](const TransferResult& result) { results_.push_back(result); });
  }
  submap_update_t answer(const map_request_t& request) {
    submap_update_t update = make_submap_update(submaps_.at(request.submap_id), request.base_revision);
    if (spoil_) spoil_(&update);
    return update;
  }

  submap_summary_t summary(int id) const {
    submap_summary_t s{};
    s.session = kSession;
    s.submap_id = id;
    s.kind = submap_update_t::BACK;
    s.closed = true;
    s.in_map = true;
    s.revision = submaps_.at(id).revision;
    s.keyframes = static_cast<int32_t>(submaps_.at(id).keyframes.size());
    s.map_from_submap = to_wire(Sim3());
    return s;
  }
  void tell(std::vector<submap_summary_t> summaries) {
    map_status_t status{};
    status.nsubmaps = static_cast<int32_t>(summaries.size());
    status.submaps = std::move(summaries);
    MapOverview map;
    map.take(status);
    fetcher_.on_map(map);
    settle(3);
  }
  void settle(int steps) {
    for (int i = 0; i < steps; ++i) {
      bus_.dispatch();
      bus_.set_now_us(bus_.now_us() + 100'000);
      fetcher_.tick(bus_.now_us());
      sender_.tick(bus_.now_us());
    }
    bus_.dispatch();
  }

  MemoryBus bus_;
  std::map<int, Submap> submaps_;
  ChunkSender sender_;
  std::vector<map_request_t> requests_;
  std::vector<TransferResult> results_;
  std::vector<int> taken_, forgotten_;
  std::string refusal_;
  bool silent_ = false, busy_ = false;
  int cut_ = 0;
  std::function<void(submap_update_t*)> spoil_;
  BackSubmapFetcher fetcher_;
};

TEST_F(BackSubmapFetcherTest, TakesWhatTheMapHoldsOnceOldestFirst) {
  tell({summary(-3), summary(-2), summary(-1)});
  EXPECT_EQ(taken_, (std::vector<int>{-1, -2, -3}));
  tell({summary(-3), summary(-2), summary(-1)});
  settle(50);
  EXPECT_EQ(requests_.size(), 3u);
  EXPECT_EQ(fetcher_.refused(), 0);
  submaps_[-2].revision += 1;
  tell({summary(-3), summary(-2), summary(-1)});
  EXPECT_EQ(taken_, (std::vector<int>{-1, -2, -3, -2})) << "it has changed";
}

TEST_F(BackSubmapFetcherTest, AMapOfSeveralPagesIsLearnedWholeAndNothingIsForgotten) {
  MapOverview map;
  for (const int id : {-2, -1, -3, -2}) {
    map_status_t page{};
    page.back_submaps = 3;
    page.nsubmaps = 1;
    page.submaps = {summary(id)};
    map.take(page);
    fetcher_.on_map(map);
    settle(3);
  }
  EXPECT_EQ(taken_, (std::vector<int>{-2, -1, -3}));
  EXPECT_TRUE(forgotten_.empty());
}

TEST_F(BackSubmapFetcherTest, AsksForNothingElse) {
  submap_summary_t apart = summary(-1), open = summary(-2), foreign = summary(-3), front = summary(-1);
  apart.in_map = false;
  open.closed = false;
  foreign.session = kSession + 1;
  front.submap_id = 1;
  front.kind = submap_update_t::FRONT;
  tell({apart, open, foreign, front});
  EXPECT_TRUE(requests_.empty());
}

TEST_F(BackSubmapFetcherTest, WhatLeavesTheMapIsForgottenAndMayComeBack) {
  tell({summary(-1), summary(-2)});
  submap_summary_t apart = summary(-1);
  apart.in_map = false;
  tell({apart, summary(-2)});
  EXPECT_EQ(forgotten_, std::vector<int>{-1});
  tell({apart, summary(-2)});
  EXPECT_EQ(forgotten_.size(), 1u);
  tell({summary(-1), summary(-2)});
  EXPECT_EQ(taken_, (std::vector<int>{-1, -2, -1}));
}

TEST_F(BackSubmapFetcherTest, ArrivesOverABusThatLosesAThird) {
  std::mt19937 rng(3);
  bus_.set_tap([&rng](const std::string&, auto) { return rng() % 3 != 0; });
  for (int i = 0; i < 60; ++i) tell({summary(-3), summary(-2), summary(-1)});
  EXPECT_EQ(taken_, (std::vector<int>{-1, -2, -3}));
}

TEST_F(BackSubmapFetcherTest, AsksAgainWhenNobodyAnswers) {
  silent_ = true;
  tell({summary(-1)});
  settle(50);
  EXPECT_GE(requests_.size(), 2u);
  EXPECT_LE(requests_.size(), 4u) << "and not all the time";
  silent_ = false, busy_ = true;
  settle(50);
  EXPECT_TRUE(taken_.empty());
  busy_ = false;
  settle(50);
  EXPECT_EQ(taken_, std::vector<int>{-1});
}

TEST_F(BackSubmapFetcherTest, DamagedOnesAreRefusedOnceAndSaidWhy) {
  const auto expect_refused = [&](const std::string& words) {
    const int64_t before = fetcher_.refused();
    ++submaps_[-1].revision;
    tell({summary(-1)});
    const size_t asked = requests_.size();
    tell({summary(-1)});
    EXPECT_EQ(fetcher_.refused(), before + 1);
    EXPECT_NE(fetcher_.problem().find(words), std::string::npos) << fetcher_.problem();
    EXPECT_EQ(requests_.size(), asked) << "it would be the same again";
    ASSERT_FALSE(results_.empty());
    EXPECT_FALSE(results_.back().ok) << "map_server hears of it";
    EXPECT_NE(results_.back().reason.find(words), std::string::npos);
  };
  cut_ = 3;
  expect_refused("bytes that are no submap update");
  cut_ = 0;
  spoil_ = [](submap_update_t* u) { u->landmarks[3].position[1] = std::numeric_limits<double>::quiet_NaN(); };
  expect_refused("landmark 3");
  spoil_ = [](submap_update_t* u) { u->keyframes[1].cam_from_submap.quat[2] = 9; };
  expect_refused("keyframe 1");
  spoil_ = [](submap_update_t* u) { u->submap_id = -2; };
  expect_refused("submap -2 of session 7 came instead");
  spoil_ = nullptr;
  refusal_ = "no use for it";
  expect_refused("no use for it");
  refusal_.clear();
  ++submaps_[-1].revision;
  tell({summary(-1), summary(-2)});
  EXPECT_EQ(taken_, (std::vector<int>{-1, -2})) << "the next ones are taken";
}

TEST_F(BackSubmapFetcherTest, TooLargeOnesAreNotAskedFor) {
  submap_summary_t large = summary(-1);
  large.keyframes = 101;
  tell({large, summary(-2)});
  tell({large, summary(-2)});
  EXPECT_EQ(taken_, std::vector<int>{-2});
  EXPECT_EQ(requests_.size(), 1u);
  EXPECT_EQ(fetcher_.refused(), 1);
  EXPECT_NE(fetcher_.problem().find("101 keyframes"), std::string::npos) << fetcher_.problem();
}

TEST_F(BackSubmapFetcherTest, WhatNobodyAskedForIsNotTaken) {
  std::vector<TransferResult> results;
  const auto send = [&](int32_t request_id) {
    sender_.send("front", chunk_t::SUBMAP_UPDATE, request_id, encode_message(make_submap_update(submaps_.at(-1), 0)),
                 [&](const TransferResult& result) { results.push_back(result); });
    settle(3);
  };
  send(0);
  tell({summary(-1)});
  send(requests_.back().request_id);  // the same once more
  ASSERT_EQ(results.size(), 2u);
  for (const TransferResult& result : results) EXPECT_EQ(result.reason, "not asked for");
  EXPECT_EQ(taken_, std::vector<int>{-1});
}

TEST_F(BackSubmapFetcherTest, ANewSessionBeginsAfresh) {
  tell({summary(-1)});
  fetcher_.begin_session(kSession + 1);
  tell({summary(-1)});
  EXPECT_EQ(requests_.size(), 1u);
  submaps_[-1].key.session = kSession + 1;
  submap_summary_t next = summary(-1);
  next.session = kSession + 1;
  tell({next});
  EXPECT_EQ(taken_, (std::vector<int>{-1, -1}));
}

}  // namespace
}  // namespace rumi::front_tracker
