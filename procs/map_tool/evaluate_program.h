#pragma once

namespace vismap {

/// Whether the command of a command line of vismap-map is `evaluate`, which is a program of its
/// own. Only options with a value may stand before it.
bool ChoosesEvaluate(int argc, char** argv);

/// Replaces this process by vismap-evaluate in the same folder, with the same options. Returns an
/// exit code only if it cannot be started, after an error message on stderr.
int RunEvaluateProgram(int argc, char** argv);

}  // namespace vismap
