// SPDX-License-Identifier: BSD-3-Clause
// A process with a node that answers requests, for lcm_process_test.cpp.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <thread>

#include "base/command_line/command_line.h"
#include "bus/process/process.h"
#include "lcmtypes/rumi/map_request_t.hpp"

namespace {

struct Options {
  std::string input;
  int step = 1;
  int spare = 0;
  int end_after = 0;
  bool never_finished = false;
  double hands_on_for_s = 0;
  int slow_ms = 0;
  bool fail = false;
};

class EchoNode : public rumi::Node {
 public:
  EchoNode(rumi::Bus& bus, const Options& options) : options_(options) {
    if (options.fail) throw std::runtime_error("no such camera");
    bus.subscribe<rumi::map_request_t>(rumi::channels::kCamera, {}, [&](const rumi::map_request_t& request) {
      if (options_.slow_ms > 0) std::fputs("at work\n", stderr);
      std::this_thread::sleep_for(std::chrono::milliseconds(options_.slow_ms));
      rumi::map_request_t answer = request;
      answer.request_id += options_.step;
      bus.publish(rumi::channels::kTrack, answer);
      ++answered_;
    });
  }
  void set(const Options& options) { options_ = options; }
  void tick(int64_t) override {}
  rumi::NodeStatus status() override { return {}; }
  bool done() const override { return options_.end_after > 0 && answered_ >= options_.end_after; }
  void finish() override { finish_ = Clock::now(); }
  std::string waits_for() const override {
    const bool finished = !options_.never_finished && finishing_for().count() >= options_.hands_on_for_s;
    return finished ? "" : "nobody took it";
  }
  int64_t handed_on() const override { return std::llround(10 * finishing_for().count()); }

 private:
  using Clock = std::chrono::steady_clock;
  std::chrono::duration<double> finishing_for() const {
    return std::chrono::duration<double>(options_.hands_on_for_s > 0 ? Clock::now() - finish_ : Clock::duration());
  }
  Options options_;
  Clock::time_point finish_;
  int answered_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
  Options options;
  return rumi::run_process(argc, argv,
                           {"test_process", "Answers requests.",
                            [&](rumi::CommandLine& app, std::vector<std::string>*) {
                              app.add_option("INPUT", options.input, "ignored")->type_name("");
                              app.add_option("--end-after", options.end_after, "answers");
                              app.add_flag("--never-finished", options.never_finished, "does not end when asked");
                              app.add_option("--hands-on-for", options.hands_on_for_s, "s, when asked to end");
                              app.add_option("--slow", options.slow_ms, "ms that an answer takes");
                              app.add_flag("--fail", options.fail, "cannot start");
                            },
                            [&](rumi::OptionTable& table) {
                              table.add("test_process.step", &options.step, "", "added to the request id", 0, 1000);
                              table.for_users({"test_process.step"});
                              table.add("test_process.spare", &options.spare, "", "for experts", 0, 9);
                            },
                            [&](rumi::Bus& bus) { return std::make_unique<EchoNode>(bus, options); },
                            [&](rumi::Node& node) { static_cast<EchoNode&>(node).set(options); },
                            [&] { return options.step == 13 ? "step is 13: unlucky" : ""; }, "test_process 1"});
}
