#pragma once

#include <string>
#include <tl/expected.hpp>
#include <utility>

namespace vismap {

/// What the world did wrong: one sentence that names the file, channel or field, what was expected
/// and what was found.
struct Error {
  std::string message;
};

/// A value, or the sentence that says why there is none. For faults of the world (files, messages,
/// configs, poses); our own bugs throw (see Require), legitimate absence is std::optional.
template <typename T>
using Result = tl::expected<T, Error>;

/// The error side of a Result: `return Fail("pose.txt: expected 16 numbers, found 12");`
inline tl::unexpected<Error> Fail(std::string message) {
  return tl::unexpected<Error>(Error{std::move(message)});
}

}  // namespace vismap
