#pragma once

#include <string>

#include "pictures/report.h"

namespace vismap {

/// Of a picture in a report [px].
struct PictureSize {
  int width = 0, height = 0;
};

// The parts of a report that need no pictures. Each returns HTML.

/// JSON as tables within tables. Says so when it is not JSON.
std::string JsonTables(const std::string& json);
/// The durations of the stages of the run, with bars.
std::string StageTimesHtml(const ReportInput& input);
/// What the run found suspect.
std::string FindingsHtml(const ReportInput& input);
std::string ProcessesHtml(const ReportInput& input);
/// A sentence in a paragraph.
std::string Remark(const std::string& sentence);
/// A number with so many digits behind the point; "" if it is not finite.
std::string Digits(double value, int digits);

}  // namespace vismap
