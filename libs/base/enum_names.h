#pragma once

#include <string>

namespace vismap {

/// A value of an enum and its name outside of the program: in config files, and in lower case on
/// command lines. An enum that has names there has a function NamesOf(Enum) beside it that returns
/// an array of these, so that it is found by its argument.
template <typename Enum>
struct EnumName {
  const char* name;
  Enum value;
};

/// The name of a value; empty = it has none.
template <typename Enum>
std::string NameOf(Enum value) {
  for (const auto& entry : NamesOf(value)) {
    if (entry.value == value) return entry.name;
  }
  return "";
}

}  // namespace vismap
