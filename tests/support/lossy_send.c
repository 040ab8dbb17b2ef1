// SPDX-License-Identifier: BSD-3-Clause
// Plays a bad network without the kernel's help (LD_PRELOAD): datagrams that a program sends are lost, sent twice, or
// held back until after the next one, at random from a seed. RUMI_LOSSY="LOSS DUPLICATE REORDER SEED", the first three
// in per cent. At its end the program says on stderr how many datagrams there were of each kind.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <pthread.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/uio.h>

typedef ssize_t (*sendmsg_t)(int, const struct msghdr*, int);

static pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;
static sendmsg_t real_sendmsg;
static double loss, duplicate, reorder;
static uint64_t state;
static long sent, lost, doubled, reordered;

// The datagram that is held back.
static struct {
  char data[65536];
  size_t size;
  struct sockaddr_storage to;
  socklen_t to_size;
  int fd;
} held;

__attribute__((constructor)) static void begin(void) {
  unsigned long seed = 1;
  const char* text = getenv("RUMI_LOSSY");
  *(void**)&real_sendmsg = dlsym(RTLD_NEXT, "sendmsg");  // the cast that POSIX prescribes: ISO C has none for this
  if (text) sscanf(text, "%lf %lf %lf %lu", &loss, &duplicate, &reorder, &seed);
  // Each program draws numbers of its own, which are the same in each run.
  state = seed * 0x9E3779B97F4A7C15u + 1;
  for (const char* c = program_invocation_short_name; *c; ++c) state = (state ^ (uint64_t)*c) * 0x100000001B3u;
}

__attribute__((destructor)) static void end(void) {
  if (sent > 0)
    fprintf(stderr, "lossy_send: %ld datagrams, %ld lost, %ld sent twice, %ld held back\n", sent, lost, doubled, reordered);
}

static int happens(double percent) {
  state ^= state << 13;
  state ^= state >> 7;
  state ^= state << 17;
  return (double)(state >> 11) * 0x1p-53 * 100 < percent;
}

static size_t size_of(const struct msghdr* message) {
  size_t size = 0;
  for (size_t i = 0; i < message->msg_iovlen; ++i) size += message->msg_iov[i].iov_len;
  return size;
}

static void hold(int fd, const struct msghdr* message) {
  held.size = 0;
  for (size_t i = 0; i < message->msg_iovlen; ++i) {
    memcpy(held.data + held.size, message->msg_iov[i].iov_base, message->msg_iov[i].iov_len);
    held.size += message->msg_iov[i].iov_len;
  }
  held.fd = fd;
  held.to_size = message->msg_namelen;
  memcpy(&held.to, message->msg_name, message->msg_namelen);
}

static void release(void) {
  struct iovec part = {held.data, held.size};
  struct msghdr message = {.msg_name = &held.to, .msg_namelen = held.to_size, .msg_iov = &part, .msg_iovlen = 1};
  if (held.size > 0) real_sendmsg(held.fd, &message, 0);
  held.size = 0;
}

static int is_datagram(int fd, const struct msghdr* message) {
  int type = 0;
  socklen_t size = sizeof type;
  if (!message->msg_name || message->msg_namelen > sizeof held.to || size_of(message) > sizeof held.data) return 0;
  return getsockopt(fd, SOL_SOCKET, SO_TYPE, &type, &size) == 0 && type == SOCK_DGRAM;
}

ssize_t sendmsg(int fd, const struct msghdr* message, int flags) {
  if (!is_datagram(fd, message)) return real_sendmsg(fd, message, flags);
  ssize_t result = (ssize_t)size_of(message);
  pthread_mutex_lock(&mutex);
  ++sent;
  if (happens(loss)) {
    ++lost;
  } else if (held.size == 0 && happens(reorder)) {
    ++reordered;
    hold(fd, message);
  } else {
    result = real_sendmsg(fd, message, flags);
    if (happens(duplicate) && ++doubled) real_sendmsg(fd, message, flags);
    release();
  }
  pthread_mutex_unlock(&mutex);
  return result;
}
