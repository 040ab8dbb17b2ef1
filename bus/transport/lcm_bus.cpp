// SPDX-License-Identifier: BSD-3-Clause
#include "bus/transport/lcm_bus.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <thread>

#include "base/files/file_descriptor.h"
#include "base/running/failures.h"
#include "base/running/log.h"
#include "base/text/number_text.h"
#include "bus/transport/handler.h"

namespace rumi {
namespace {

constexpr int kReceiveTimeoutMs = 50;        // the receive thread notices within this time that it should end
constexpr size_t kMaxLcmChannelLength = 63;  // characters; LCM refuses longer names
constexpr const char* kUsualUrl = "udpm://239.255.76.67:7667?ttl=0";
constexpr const char* kDefaultGroup = "239.255.76.67";
constexpr int64_t kWantedReceiveBuffer = 2097152;  // bytes; no raw 640x480 image was lost with it at up to 2000 Hz

// Returns the channel's name with a backslash before special characters: LCM takes names as regular expressions, ours
// are plain.
std::string escaped(const std::string& channel) {
  std::string regex;
  for (const char c : channel) {
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '_') regex += '\\';
    regex += c;
  }
  return regex;
}

std::string multicast_group(const std::string& url) {
  const size_t start = url.find("://");
  std::string group = start == std::string::npos ? "" : url.substr(start + 3);
  group = group.substr(0, group.find_first_of(":?/"));
  return group.empty() ? kDefaultGroup : group;
}

// True if the URL names a group without a valid port. LCM would then listen on no port, and report that only after
// testing itself for ten seconds.
bool lacks_port(const std::string& url) {
  std::string network = url.substr(url.find("://") + 3);
  network = network.substr(0, network.find_first_of("?/"));
  if (network.empty()) return false;
  const size_t colon = network.find(':');
  const std::string port = colon == std::string::npos ? "" : network.substr(colon + 1);
  const auto number = parse_number<int>(port);
  return !number || *number < 1 || *number > 65535;
}

// Returns why the kernel cannot send to this group, or an empty string. Checked before LCM is opened, whose own message
// is a page long. Sends nothing. Precondition: `group` is a multicast address.
std::string why_unreachable(const std::string& group) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(1);
  if (inet_pton(AF_INET, group.c_str(), &address.sin_addr) != 1) return {};
  const FileDescriptor socket_of_udp(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  if (!socket_of_udp) return {};
  const int result = connect(socket_of_udp.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address));
  return result == 0 ? "" : std::strerror(errno);
}

bool is_multicast(const std::string& group) {
  in_addr address{};
  return inet_pton(AF_INET, group.c_str(), &address) == 1 && IN_MULTICAST(ntohl(address.s_addr));
}

bool is_udpm(const std::string& url) { return url.starts_with("udpm://") || url.starts_with("mpudpm://"); }

// An Error for any URL but udpm: some of LCM's other buses cannot connect several processes, and one (tcpq) ends the
// process if its server is missing.
Result<> check_url(const std::string& url) {
  if (url.starts_with("memq://"))
    return Error{
        fmt::format("the LCM URL {} is not used: such a bus lives within one process, and Rumi is several. A usual "
                    "URL is {}",
                    url, kUsualUrl)};
  if (url.starts_with("file://"))
    return Error{
        fmt::format("the LCM URL {} is not used: it is a log file and no bus. `rumi replay FILE` plays one; a usual "
                    "URL is {}",
                    url, kUsualUrl)};
  if (!is_udpm(url))
    return Error{fmt::format("the LCM URL {} is not used: only udpm:// is, multicast. Expected an LCM URL such as {}",
                             url, kUsualUrl)};
  if (lacks_port(url))
    return Error{fmt::format("the LCM URL {} has no port from 1 to 65535; a usual one is {}", url, kUsualUrl)};
  if (const std::string group = multicast_group(url); !is_multicast(group))
    return Error{fmt::format(
        "the LCM URL {} is not used: {} is no multicast address (224.0.0.0 to 239.255.255.255); a usual URL is {}, and "
        "ttl=1 in it reaches other computers",
        url, group, kUsualUrl)};
  return {};
}

void warn_once_about_receive_buffer(const std::string& url) {
  static std::once_flag once;
  std::call_once(once, [&] {
    int64_t rmem_max = 0;
    std::ifstream("/proc/sys/net/core/rmem_max") >> rmem_max;
    const std::string advice = receive_buffer_advice(url, rmem_max);
    if (!advice.empty()) log_warning("{}", advice);
  });
}

}  // namespace

std::string ChannelNames::on_wire(const std::string& channel) const {
  return prefix + (channel == channels::kCamera ? camera : channel);
}

Result<std::unique_ptr<LcmBus>> LcmBus::open(const std::string& url, const ChannelNames& names) {
  const size_t longest = names.on_wire(channels::kCameraToSubmap).size();
  if (std::max(longest, names.on_wire(channels::kCamera).size()) > kMaxLcmChannelLength)
    return Error{
        fmt::format("--channel-prefix {} or --channel {} is too long: an LCM channel name has at most {} characters",
                    names.prefix, names.camera, kMaxLcmChannelLength)};
  if (const Result<> usable = check_url(url); !usable) return usable.error();
  if (const std::string why = why_unreachable(multicast_group(url)); !why.empty())
    return Error{fmt::format("the LCM bus {} cannot be used: {}. {}", url, why, multicast_advice(url))};
  auto lcm = std::make_unique<lcm::LCM>(url);
  if (!lcm->good()) return Error{fmt::format("the LCM bus {} cannot be opened. {}", url, multicast_advice(url))};
  warn_once_about_receive_buffer(url);
  return std::unique_ptr<LcmBus>(new LcmBus(url, std::move(lcm), names));
}

LcmBus::LcmBus(std::string url, std::unique_ptr<lcm::LCM> lcm, ChannelNames names)
    : url_(std::move(url)), names_(std::move(names)), lcm_(std::move(lcm)) {}

LcmBus::~LcmBus() { stop_ = true; }

bool LcmBus::publish_raw(const std::string& channel, std::span<const uint8_t> data) {
  if (lcm_->publish(names_.on_wire(channel), data.data(), static_cast<unsigned>(data.size())) != 0) return false;
  ++published_;
  return true;
}

void LcmBus::subscribe_raw(const std::string& channel, const QueueOptions& queue, RawHandler handler) {
  auto subscription = std::make_unique<Subscription>();
  subscription->bus = this;
  subscription->queue = queue;
  subscription->handler = std::move(handler);
  subscription->counts.channel = channel;
  Subscription* added = subscription.get();
  {
    const std::lock_guard lock(mutex_);
    subscriptions_.push_back(std::move(subscription));
  }
  const lcm_msg_handler_t callback = [](const lcm_recv_buf_t* buffer, const char*, void* user) {
    auto* const to = static_cast<Subscription*>(user);
    // Exceptions must not pass through LCM, which is C.
    const std::string reason = thrown_by([&] {
      to->bus->enqueue(*to, {static_cast<const uint8_t*>(buffer->data), buffer->data_size});
    });
    if (!reason.empty()) to->bus->note_dropped(*to);
  };
  // LCM's C++ class is not used here: it takes a failed subscription for a good one.
  lcm_subscription_t* const made =
      lcm_subscribe(lcm_->getUnderlyingLCM(), escaped(names_.on_wire(channel)).c_str(), callback, added);
  if (!made) throw std::runtime_error(fmt::format("LCM on {} cannot receive. {}", url_, multicast_advice(url_)));
  // LCM's own queue is unlimited: the receive thread empties it at once into ours, which is bounded and counted.
  lcm_subscription_set_queue_capacity(made, 0);
  if (receiver_) return;
  receiver_.emplace(true);
  receiver_->post([this] { receive(); });
}

void LcmBus::receive() {
  while (!stop_) {
    if (lcm_->handleTimeout(kReceiveTimeoutMs) >= 0) continue;
    log_debug("LCM could not receive; trying again");
    std::this_thread::sleep_for(std::chrono::milliseconds(kReceiveTimeoutMs));
  }
}

void LcmBus::enqueue(Subscription& subscription, std::span<const uint8_t> data) {
  Message message{0, {data.begin(), data.end()}};
  {
    const std::lock_guard lock(mutex_);
    ++subscription.counts.received;
    const bool full = static_cast<int>(subscription.waiting.size()) >= std::max(1, subscription.queue.capacity);
    if (full) {
      ++subscription.counts.dropped;
      if (subscription.queue.drop == DropPolicy::kDropNewest) return;
      subscription.waiting.pop_front();
      --waiting_;
    }
    message.sequence = next_sequence_++;
    subscription.waiting.push_back(std::move(message));
    ++waiting_;
  }
  arrived_.notify_one();
}

void LcmBus::note_dropped(Subscription& subscription) {
  const std::lock_guard lock(mutex_);
  ++subscription.counts.dropped;
}

// Returns the subscription whose oldest waiting message arrived first, and before `sequence`; nullptr if there is no
// such message. The caller holds mutex_.
LcmBus::Subscription* LcmBus::next_before(int64_t sequence) {
  Subscription* next = nullptr;
  for (const auto& subscription : subscriptions_) {
    if (subscription->waiting.empty() || subscription->waiting.front().sequence >= sequence) continue;
    sequence = subscription->waiting.front().sequence;
    next = subscription.get();
  }
  return next;
}

int LcmBus::dispatch(int timeout_ms) {
  std::unique_lock lock(mutex_);
  arrived_.wait_for(lock, std::chrono::milliseconds(timeout_ms), [&] { return waiting_ > 0; });
  const int64_t end = next_sequence_;
  int handled = 0;
  while (Subscription* subscription = next_before(end)) {
    const Message message = std::move(subscription->waiting.front());
    subscription->waiting.pop_front();
    --waiting_;
    ++handled;
    lock.unlock();
    const bool decoded =
        handle_safely(subscription->handler, subscription->counts.channel, message.data, now_us(), &broken_handlers());
    lock.lock();
    if (!decoded) ++subscription->counts.undecodable;
  }
  return handled;
}

int64_t LcmBus::now_us() const {
  using namespace std::chrono;
  return duration_cast<microseconds>(system_clock::now().time_since_epoch()).count();
}

std::vector<ChannelCounts> LcmBus::counts() const {
  const std::lock_guard lock(mutex_);
  std::vector<ChannelCounts> all;
  for (const auto& subscription : subscriptions_) {
    all.push_back(subscription->counts);
    all.back().queue_depth = static_cast<int>(subscription->waiting.size());
  }
  return all;
}

std::string multicast_advice(const std::string& url) {
  return fmt::format(
      "Is there a multicast route? On one machine these two commands set it up:\n"
      "  sudo ip link set lo multicast on\n"
      "  sudo ip route add {}/32 dev lo",
      multicast_group(url));
}

std::string receive_buffer_advice(const std::string& url, int64_t rmem_max) {
  const std::string key = "recv_buf_size=";
  const size_t at = url.find(key);
  if (at == std::string::npos)
    return fmt::format("the LCM URL {} has no recv_buf_size: raw images may be lost; add `recv_buf_size={}` to it", url,
                       kWantedReceiveBuffer);
  const int64_t wanted = std::strtoll(url.c_str() + at + key.size(), nullptr, 10);
  if (rmem_max <= 0 || wanted <= rmem_max) return "";
  return fmt::format(
      "the kernel limits receive buffers to {} bytes, {} are wanted: large images may be lost when the machine is "
      "busy; "
      "`sudo sysctl -w net.core.rmem_max={}` helps",
      rmem_max, wanted, wanted);
}

}  // namespace rumi
