#pragma once

#include <string>
#include <vector>

#include "base/result.h"

namespace vismap {

// How DimOS starts a program as one of its native modules: options with underscores, and on request
// one line of JSON on the standard input.

/// The words of a command line with dashes in the names of options: --color_image as --color-image.
std::vector<std::string> WithDashes(const std::vector<std::string>& words);

/// Whether the words ask for a line on the standard input: "--stdin-config true".
bool WantsStdinConfig(const std::vector<std::string>& words);

/// Reads one line from the standard input, of at most a megabyte, within `timeout` [s]. Fails when
/// none comes.
Result<std::string> ReadStdinLine(double timeout);

/// Adds what the line of DimOS says, {"topics": {PORT: CHANNEL}, "config": {FIELD: VALUE} or null,
/// ...}, as options, where the words do not have them already. "session" and "qos" say nothing to a
/// program on LCM. Fails, naming the member, on what is not of this form.
Result<std::vector<std::string>> WithStdinConfig(std::vector<std::string> words,
                                                 const std::string& line);

/// What is wrong when DimOS does not use LCM: a sentence; "" = nothing. `transport` is the value of
/// $DIMOS_TRANSPORT.
std::string TransportProblem(const std::string& transport);

}  // namespace vismap
