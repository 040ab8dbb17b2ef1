// SPDX-License-Identifier: BSD-3-Clause
#include "formats/bag/decompress.h"

#include <bzlib.h>
#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <memory>

namespace rumi {
namespace {

constexpr size_t kMostBytes = size_t{256} << 20;  // largest unpacked chunk: bags have chunks of some megabytes

enum class State { kGoesOn, kEnded, kDamaged };

// A stream takes bytes from the front of `in`, puts bytes at the front of `out`, and shortens both.
class Stream {
 public:
  virtual ~Stream() = default;
  virtual State step(std::span<uint8_t>* in, std::span<uint8_t>* out) = 0;
};

class Bz2Stream : public Stream {
 public:
  Bz2Stream() { BZ2_bzDecompressInit(&stream_, 0, 0); }
  ~Bz2Stream() override { BZ2_bzDecompressEnd(&stream_); }
  State step(std::span<uint8_t>* in, std::span<uint8_t>* out) override {
    stream_.next_in = reinterpret_cast<char*>(in->data());
    stream_.avail_in = static_cast<unsigned>(in->size());
    stream_.next_out = reinterpret_cast<char*>(out->data());
    stream_.avail_out = static_cast<unsigned>(out->size());
    const int code = BZ2_bzDecompress(&stream_);
    *in = in->last(stream_.avail_in);
    *out = out->last(stream_.avail_out);
    if (code == BZ_STREAM_END) return State::kEnded;
    return code == BZ_OK ? State::kGoesOn : State::kDamaged;
  }

 private:
  bz_stream stream_{};
};

class Lz4Stream : public Stream {
 public:
  Lz4Stream() { LZ4F_createDecompressionContext(&context_, LZ4F_VERSION); }
  ~Lz4Stream() override { LZ4F_freeDecompressionContext(context_); }
  State step(std::span<uint8_t>* in, std::span<uint8_t>* out) override {
    size_t taken = in->size(), put = out->size();
    const size_t code = LZ4F_decompress(context_, out->data(), &put, in->data(), &taken, nullptr);
    if (LZ4F_isError(code)) return State::kDamaged;
    *in = in->subspan(taken);
    *out = out->subspan(put);
    return code == 0 ? State::kEnded : State::kGoesOn;
  }

 private:
  LZ4F_dctx* context_ = nullptr;
};

class ZstdStream : public Stream {
 public:
  ZstdStream() : stream_(ZSTD_createDStream()) {}
  ~ZstdStream() override { ZSTD_freeDStream(stream_); }
  State step(std::span<uint8_t>* in, std::span<uint8_t>* out) override {
    ZSTD_inBuffer from{in->data(), in->size(), 0};
    ZSTD_outBuffer to{out->data(), out->size(), 0};
    const size_t code = ZSTD_decompressStream(stream_, &to, &from);
    if (ZSTD_isError(code)) return State::kDamaged;
    *in = in->subspan(from.pos);
    *out = out->subspan(to.pos);
    return code == 0 ? State::kEnded : State::kGoesOn;
  }

 private:
  ZSTD_DStream* stream_;
};

std::unique_ptr<Stream> make_stream(Compression compression) {
  if (compression == Compression::kBz2) return std::make_unique<Bz2Stream>();
  if (compression == Compression::kLz4) return std::make_unique<Lz4Stream>();
  return std::make_unique<ZstdStream>();
}

class Unpacking {
 public:
  explicit Unpacking(Compression compression) : stream_(make_stream(compression)) {}

  // Unpacks all of `in`, or its part up to the end of the stream.
  State take(std::span<uint8_t> in) {
    for (;;) {
      std::array<uint8_t, 64 << 10> piece;
      std::span<uint8_t> left = piece;
      const size_t before = in.size();
      const State state = stream_->step(&in, &left);
      const size_t put = piece.size() - left.size();
      result_.stored_bytes += static_cast<int64_t>(before - in.size());
      if (state == State::kDamaged) return state;
      if (result_.bytes.size() + put > kMostBytes) {
        result_.bytes.clear();
        return State::kDamaged;
      }
      result_.bytes.insert(result_.bytes.end(), piece.begin(), piece.begin() + static_cast<ptrdiff_t>(put));
      if (state == State::kEnded) return state;
      const bool may_have_more = left.empty();
      if (in.empty() && !may_have_more) return State::kGoesOn;
      if (before == in.size() && put == 0) return in.empty() ? State::kGoesOn : State::kDamaged;
    }
  }
  Decompressed& result() { return result_; }

 private:
  std::unique_ptr<Stream> stream_;
  Decompressed result_;
};

}  // namespace

std::optional<Compression> compression_named(const std::string& name) {
  if (name.empty() || name == "none") return Compression::kNone;
  if (name == "bz2") return Compression::kBz2;
  if (name == "lz4") return Compression::kLz4;
  if (name == "zstd") return Compression::kZstd;
  return std::nullopt;
}

Decompressed decompress(ByteSource& source, int64_t at, int64_t stored_bytes, Compression compression) {
  Unpacking unpacking(compression);
  std::vector<uint8_t> piece(64 << 10);
  State state = State::kGoesOn;
  for (int64_t end = std::min(source.size(), at + stored_bytes); at < end && state == State::kGoesOn;) {
    const auto count = static_cast<size_t>(std::min<int64_t>(end - at, static_cast<int64_t>(piece.size())));
    const std::span<uint8_t> in(piece.data(), count);
    if (!source.read(at, in)) break;
    state = unpacking.take(in);
    at += static_cast<int64_t>(count);
  }
  Decompressed& result = unpacking.result();
  result.is_whole = state == State::kEnded;
  result.is_cut_off = state == State::kGoesOn;
  return std::move(result);
}

bool looks_like_zstd(std::span<const uint8_t> bytes) {
  static constexpr std::array<uint8_t, 4> kMagic = {0x28, 0xB5, 0x2F, 0xFD};
  return bytes.size() > kMagic.size() && std::equal(kMagic.begin(), kMagic.end(), bytes.begin());
}

}  // namespace rumi
