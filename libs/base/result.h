#pragma once

#include <string>
#include <tl/expected.hpp>
#include <utility>

namespace vismap {

/// An error of the input: one sentence that names the file, channel or field, what was expected and
/// what was found.
struct Error {
  std::string message;
};

/// A value, or an Error that says why there is none. For faulty input such as files, messages,
/// configs and poses. Bugs of the program throw instead (see Require); a value that may be absent
/// is a std::optional.
template <typename T>
using Result = tl::expected<T, Error>;

/// The error side of a Result: `return Fail("pose.txt: expected 16 numbers, found 12");`
inline tl::unexpected<Error> Fail(std::string message) {
  return tl::unexpected<Error>(Error{std::move(message)});
}

}  // namespace vismap
