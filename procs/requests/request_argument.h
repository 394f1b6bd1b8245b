#pragma once

#include <map>
#include <string>
#include <vector>

#include "base/result.h"

namespace vismap {

/// The argument of a request that has keys: "height=1.2;band=0.1,0.8".
class RequestArgument {
 public:
  /// A part without '=' belongs to the value before it, so that values may contain ';'. Fails on a
  /// key that is not one of `known`, and on one that is given twice.
  static Result<RequestArgument> Read(const std::string& text,
                                      const std::vector<std::string>& known);

  bool Has(const std::string& key) const { return values_.contains(key); }
  /// The value of a key; "" when it is not given.
  std::string Text(const std::string& key) const;
  /// `count` finite numbers, separated by commas. The key must be given.
  Result<std::vector<double>> Numbers(const std::string& key, size_t count) const;
  /// One number; `usual` when the key is not given.
  Result<double> Number(const std::string& key, double usual) const;

 private:
  std::map<std::string, std::string> values_;
};

/// `count` finite numbers, separated by commas; `what` names them in the error.
Result<std::vector<double>> ReadNumbersOf(const std::string& what, const std::string& text,
                                          size_t count);

}  // namespace vismap
