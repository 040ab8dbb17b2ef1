// SPDX-License-Identifier: BSD-3-Clause
// How a function reports an expected failure: a missing file, a malformed message. (A broken invariant throws; see
// docs/architecture.md, "Rules".) Based on tl::expected, the forerunner of std::expected.
//
//   Result<Camera> read(const std::string& file);           Result<> write(const std::string& file);
//   const Result<Camera> camera = read(file);
//   if (!camera) return camera.error();                      // an Error is a Result of any type
//   use(*camera);
#pragma once

#include <string>
#include <tl/expected.hpp>
#include <utility>

namespace rumi {

// An error for a person. `where`: file, line, field or message; `remedy`: what to do. Both may be empty.
struct Error {
  std::string what, where = {}, remedy = {};

  // Returns "where: what; remedy".
  std::string text() const {
    return (where.empty() ? "" : where + ": ") + what + (remedy.empty() ? "" : "; " + remedy);
  }
  bool operator==(const Error&) const = default;
};

// A value or an Error. The compiler refuses to ignore a Result.
template <class T = void>
class [[nodiscard]] Result : public tl::expected<T, Error> {
  using Base = tl::expected<T, Error>;

 public:
  using Base::Base;
  Result(Error error) : Base(tl::unexpect, std::move(error)) {}  // NOLINT(google-explicit-constructor)

  // Returns the error's text(); empty if there is a value. For messages and tests.
  std::string error_text() const { return this->has_value() ? "" : this->error().text(); }
};

}  // namespace rumi
