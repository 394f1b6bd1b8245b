#include "base/option_check.h"

#include <cstdio>

namespace vismap {
namespace {

std::string Text(double number) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.10g", number);
  return text;
}

std::string KeyOf(const std::string& expression) {
  return expression.substr(expression.rfind('.') + 1);  // all of it when there is no point
}

}  // namespace

void OptionCheck::Unless(bool ok, const std::string& sentence) {
  if (!ok) problems_.push_back(sentence);
}

void OptionCheck::Range(const std::string& expression, double value, double least, double most) {
  Unless(value >= least && value <= most,
         KeyOf(expression) + " must be in [" + Text(least) + ", " + Text(most) + "]");
}

void OptionCheck::AtLeast(const std::string& expression, double value, double least) {
  Unless(value >= least, KeyOf(expression) + " must be at least " + Text(least));
}

void OptionCheck::Odd(const std::string& expression, int value, int least, int most) {
  Unless(value >= least && value <= most && value % 2 == 1,
         KeyOf(expression) + " must be odd and in [" + std::to_string(least) + ", " +
             std::to_string(most) + "]");
}

void OptionCheck::Add(const std::string& prefix, const std::vector<std::string>& problems) {
  for (const std::string& problem : problems) problems_.push_back(prefix + problem);
}

}  // namespace vismap
