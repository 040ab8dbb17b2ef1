// SPDX-License-Identifier: BSD-3-Clause
// Runs a process around its node: flags, logging, the LCM connection, the 1 Hz status, a clean end.
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
  double processing_ms = 0;    // mean time per item (image or window) since the last status
  int64_t refused_images = 0;  // images so far whose message could be decoded, but which could not be used
};

// A component: messages in, messages out. It subscribes in its constructor; all its methods run on one thread.
class Node {
 public:
  virtual ~Node() = default;
  // Called often (every 20 ms or so live, after every frame in replay) with the bus's time.
  virtual void tick(int64_t now_us) = 0;
  // Returns the time by which tick() must be called, for nodes that keep a pace; used live only. Messages that come in
  // may cause an earlier call.
  virtual int64_t next_tick_us(int64_t now_us) const { return now_us + 20'000; }
  virtual NodeStatus status() = 0;
  // Called when the input has ended: finishes what is open and publishes what is unpublished. Afterwards the bus is
  // still dispatched until finished(). This ends when handed_on() has not changed for 5 s, except in a process that was
  // asked to finish (SIGUSR1): that one takes as long as it needs.
  virtual void finish() {}
  // Called when the process is asked to end now (SIGINT, SIGTERM): does the same as finish(), but leaves out what may
  // take longer than 5 s.
  virtual void stop() { finish(); }
  // If it returns true, the process ends; used live only (a camera_driver that came to the end of its dataset).
  virtual bool done() const { return false; }
  // Describes, for a person, what the node has yet to do or to hand on; empty: nothing.
  virtual std::string waits_for() const { return {}; }
  bool finished() const { return waits_for().empty(); }
  // Returns a sentence for each input that is missing from the process's results, with what to do about it. The process
  // logs them last, and its exit code is then kNotAll.
  virtual std::vector<std::string> complaints() const { return {}; }
  // Returns a number that changes each time other processes have received more of what this node has to hand on.
  virtual int64_t handed_on() const { return 0; }
};

struct ProcessDescription {
  std::string name;     // such as "front_tracker"
  std::string summary;  // one or two lines for --help
  // Adds the process's own flags to the command line (may be empty). A flag that abbreviates an option is appended to
  // the settings (by_flag()).
  std::function<void(CommandLine&, std::vector<std::string>* settings)> add_flags;
  // Registers its options (may be empty).
  std::function<void(OptionTable&)> add_options;
  // Makes the node once everything is parsed; throws std::runtime_error with a message for the user if it cannot.
  std::function<std::unique_ptr<Node>(Bus&)> make_node;
  // Called after SIGUSR2, when the options were read again from --config and --set without an error. Throws if the node
  // cannot use them all the same. If it is empty, SIGUSR2 is not caught. (SIGHUP is not used for this: a closed
  // terminal must end the process.)
  std::function<void(Node&)> on_reload = {};
  // Checks the options against each other, once all are read. Returns a message for the user, or an empty string if
  // they can be used. May be empty.
  std::function<std::string()> check_options = {};
  std::string about = {};  // the text of --version (base/command_line/about.h)
  // only_one: a bus may have only one process of this name (only_one.h). only_one_on_channel: a bus may have several,
  // but only one that publishes on a given camera channel.
  bool only_one = false;
  bool only_one_on_channel = false;
};

// Runs a process: its main() calls this. Flags of every process: -l/--lcm-url URL (else LCM_DEFAULT_URL, else udpm with
// TTL 0 and a large receive buffer), --channel-prefix P, -c/--channel NAME (the camera's channel), --config FILE, --set
// KEY=VALUE, -v, -q, -h, --help-expert, --version. Returns the exit code: 0; kNotAll if the node complains; 1 for a
// failure; 2 if starting the process again would not help, because the command line is wrong or the bus has another
// process of which it may have only one. A second SIGINT or SIGTERM ends the process at once.
int run_process(int argc, char** argv, const ProcessDescription& description);

// The 1 Hz status of a node on any bus; call after every dispatch.
class StatusPublisher {
 public:
  // `lost`: returns how many datagrams found the receive buffer full so far (ReceiveLosses). It is empty for buses that
  // lose no datagrams.
  StatusPublisher(Bus& bus, std::string process_name, std::function<int64_t()> lost = {});
  // Puts into every status what OnlyOne compares: when this process began, and the channel of which it is the only
  // publisher (may be empty).
  void set_claim(int64_t started_us, const std::string& publishes);
  void tick(Node& node, int64_t now_us);
  // Publishes a status now, because another process asked who is on the bus.
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
