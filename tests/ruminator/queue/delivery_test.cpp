// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/queue/delivery.h"

#include <gmock/gmock.h>

#include "bus/transport/memory_bus.h"
#include "bus/wire/submap_update.h"
#include "tests/ruminator/test_jobs.h"

namespace rumi::ruminator {
namespace {

using ::testing::ElementsAre;
using testing::fake_submap;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::small_job;

constexpr double kRetryS = 2;

// A map_server that stores submaps, or refuses them with a reason.
class DeliveryTest : public ::testing::TestWithParam<bool> {
 protected:
  DeliveryTest()
      : receiver_(bus_, channels::kSubmap, channels::kSubmapAck, "map_server", true,
                  [this](const ChunkReceiver::Payload& payload) { return take(payload); }) {
    bus_.set_now_us(1'000'000);
    windows_.emplace(bus_, GetParam() ? folder_ / "spool" : std::string(), 1'000'000);
    delivery_.emplace(bus_, *windows_, kRetryS);
  }
  // Adds a window that has just been rebuilt.
  QueueEntry& build(int32_t id) {
    const WindowJob job = small_job(id);
    QueueEntry& entry = windows_->entries().emplace_back();
    entry.name = name_of(job.window);
    entry.window = job.window;
    if (Spool* const spool = windows_->spool()) {
      EXPECT_TRUE(spool->add(job));
      EXPECT_TRUE(windows_->claim(entry));
    } else {
      entry.place = InMemory{std::make_shared<const WindowJob>(job), {}};
    }
    delivery_->store(entry, encode_message(make_submap_update(fake_submap(job), 0)));
    return entry;
  }
  void run_for(double seconds) {
    for (const int64_t end = bus_.now_us() + static_cast<int64_t>(seconds * 1e6); bus_.now_us() < end;) {
      bus_.set_now_us(bus_.now_us() + 20'000);
      delivery_->tick(bus_.now_us());
      delivery_->send_next(bus_.now_us());
      bus_.dispatch();
      receiver_.tick(bus_.now_us());
      bus_.dispatch();
    }
  }
  ChunkReceiver::Verdict take(const ChunkReceiver::Payload& payload) {
    ++attempts_;
    submap_update_t update;
    EXPECT_TRUE(Bus::decode(payload.bytes, &update));
    if (!refusal_.empty()) return {false, refusal_, 0};
    received_.push_back(update.submap_id);
    return {true, "", update.revision};
  }

  testing::TemporaryFolder folder_;
  MemoryBus bus_;
  ChunkReceiver receiver_;
  std::optional<QueuedWindows> windows_;
  std::optional<Delivery> delivery_;
  std::vector<int32_t> received_;
  int attempts_ = 0;
  std::string refusal_;
};

TEST_P(DeliveryTest, BackSubmapsAreSentOneAfterAnother) {
  EXPECT_EQ(build(1).holds_submap(), !GetParam()) << "with a spool, no memory is held";
  build(2);
  run_for(1);
  EXPECT_THAT(received_, ElementsAre(-1, -2));
  EXPECT_THAT(windows_->entries(), IsEmpty());
  EXPECT_EQ(delivery_->published(), 2);
  if (windows_->spool()) {
    EXPECT_THAT(windows_->spool()->built(), IsEmpty());
  }
}

TEST_P(DeliveryTest, ARefusedSubmapIsSentAgainAfterAWhile) {
  refusal_ = "disk full";
  build(1);
  run_for(1);
  EXPECT_EQ(attempts_, 1);
  EXPECT_EQ(delivery_->problem(), "disk full");
  refusal_.clear();
  run_for(kRetryS);
  EXPECT_THAT(received_, ElementsAre(-1));
  EXPECT_EQ(delivery_->problem(), "");
}

TEST_P(DeliveryTest, FinishingSendsOnceAndLeavesWhatIsRefused) {
  refusal_ = "disk full";
  QueueEntry& entry = build(1);
  delivery_->finish();
  run_for(1 + kRetryS);
  EXPECT_EQ(attempts_, 1);
  EXPECT_TRUE(entry.is<LeftForNextStart>());
  if (windows_->spool()) {
    EXPECT_THAT(windows_->spool()->built(), ElementsAre(JobName{7, 1}));
  }
}

TEST_P(DeliveryTest, AFileThatIsDamagedIsAFailure) {
  if (!GetParam()) return;
  build(1);
  testing::write_file(folder_ / "spool/7-1.submap", "nonsense that is long enough");
  run_for(1);
  EXPECT_EQ(attempts_, 0);
  EXPECT_THAT(windows_->entries(), IsEmpty());
  EXPECT_EQ(windows_->failed(), 1);
  EXPECT_THAT(testing::read_file(folder_ / "spool/failed/7-1.txt"), HasSubstr("its back submap cannot be sent"));
}

INSTANTIATE_TEST_SUITE_P(Places, DeliveryTest, ::testing::Bool(),
                         [](const auto& place) { return std::string(place.param ? "Spool" : "Memory"); });

}  // namespace
}  // namespace rumi::ruminator
