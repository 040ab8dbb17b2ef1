// SPDX-License-Identifier: BSD-3-Clause
// The frame of the five processes: flags, logging, the LCM connection, the 1 Hz status, a clean end.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/command_line/options.h"
#include "base/running/due.h"
#include "bus/transport/bus.h"

namespace rumi {

class CommandLine;

struct NodeStatus {
  std::string detail;     // one line for a person
  bool degraded = false;  // works, but detail says what does not
  int64_t last_utime_us = 0;
  double processing_ms = 0;    // mean per item since the last status
  int64_t refused_images = 0;  // messages that could be decoded and were refused, so far
};

// A component: messages in, messages out. It subscribes in its constructor; all its methods run on one thread.
class Node {
 public:
  virtual ~Node() = default;
  // Called often (every 20 ms or so live, after every frame in replay) with the bus's time.
  virtual void tick(int64_t now_us) = 0;
  // Live: when tick() is wanted at the latest, for those who keep a pace. Messages that come in may make it sooner.
  virtual int64_t next_tick_us(int64_t now_us) const { return now_us + 20'000; }
  virtual NodeStatus status() = 0;
  // The input has ended: finish what is open, publish what is unpublished. After it the bus is still dispatched until
  // finished(): until handed_on() has not changed for 5 s, or, if the process was asked for it (SIGUSR1), for as long
  // as it takes.
  virtual void finish() {}
  // The process is asked to end now (SIGINT, SIGTERM): the same, but for what may take longer than 5 s.
  virtual void stop() { finish(); }
  // Live: true ends the process (a camera_driver that came to the end of its dataset).
  virtual bool done() const { return false; }
  // Describes, for a person, what the node has yet to do or to hand on; empty: nothing.
  virtual std::string waits_for() const { return {}; }
  bool finished() const { return waits_for().empty(); }
  // Says, in a sentence each with what to do, which input is missing from the process's results. This is the last thing
  // that the process says, and its exit code is then kNotAll.
  virtual std::vector<std::string> complaints() const { return {}; }
  // How much of what others wait for they have; another number each time they have more.
  virtual int64_t handed_on() const { return 0; }
};

struct ProcessDescription {
  std::string name;     // "front_tracker"
  std::string summary;  // one or two lines for --help
  // Adds the process's own flags to the command line (may be empty). Those that are short for an option are put among
  // the settings (by_flag()).
  std::function<void(CommandLine&, std::vector<std::string>* settings)> add_flags;
  // Registers its options (may be empty).
  std::function<void(OptionTable&)> add_options;
  // Makes the node once everything is parsed; throws std::runtime_error with a message for the user if it cannot.
  std::function<std::unique_ptr<Node>(Bus&)> make_node;
  // SIGUSR2: --config and --set were read again, into the fields of the options, and are right. Throws what is wrong
  // with them all the same. (Not SIGHUP: a closed terminal must end the process.)
  std::function<void(Node&)> on_reload = {};
  // Checks the options together, once all are read: returns what is wrong, or an empty string. May be empty.
  std::function<std::string()> check_options = {};
  std::string about = {};  // the text of --version (base/command_line/about.h)
  // There may be one on a bus (only_one.h): of its name, or ...
  bool only_one = false;
  bool only_one_on_channel = false;  // ... of those that publish on the camera's channel
};

// main() of a process. Flags of all: -l/--lcm-url URL (else LCM_DEFAULT_URL, else udpm with TTL 0 and a large receive
// buffer), --channel-prefix P, -c/--channel NAME (the camera's channel), --config FILE, --set KEY=VALUE, -v, -q, -h,
// --version. Returns the exit code: 0, kNotAll where the node complains, 1 for a failure, 2 where starting it again
// would not help: a wrong command line, or another one on the bus of which there may be one.
int run_process(int argc, char** argv, const ProcessDescription& description);

// The 1 Hz status of a node on any bus; call after every dispatch.
class StatusPublisher {
 public:
  // lost: returns how many datagrams found the receive buffer full so far (ReceiveLosses); empty on buses that lose
  // none.
  StatusPublisher(Bus& bus, std::string process_name, std::function<int64_t()> lost = {});
  // See OnlyOne: when the process began, and the channel that it alone publishes on.
  void set_claim(int64_t started_us, const std::string& publishes);
  void tick(Node& node, int64_t now_us);
  // Publishes now, because somebody asked.
  void answer(Node& node, int64_t now_us);
  void stopping(Node& node, int64_t now_us);

 private:
  void publish(Node& node, int64_t now_us, int8_t state);
  void note_losses(NodeStatus* status);
  Bus& bus_;
  std::string name_;
  int64_t started_us_ = 0;
  int64_t last_us_ = kNever_us;
  std::function<int64_t()> count_lost_;
  int64_t lost_ = 0;
  std::string publishes_;
};

inline constexpr const char* kDefaultLcmUrl = "udpm://239.255.76.67:7667?ttl=0&recv_buf_size=2097152";

}  // namespace rumi
