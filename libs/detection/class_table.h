#pragma once

#include <string>
#include <vector>

#include "base/ids.h"
#include "base/result.h"

namespace vismap {

/// The class that each output of a network stands for, by the network's own numbers from 0;
/// kUnknown = detections of it are dropped.
using ClassTable = std::vector<ClassId>;

/// The 80 classes that COCO annotates, in the order of their ids: what YOLO models are trained on.
ClassTable Coco80();

/// COCO's ids 1..90 without gaps: what TensorFlow's models count by.
ClassTable Coco90();

/// Reads a text file with one line per class of the network, in its order: a COCO name ("chair"),
/// "ID NAME" for any other class (ID in [1, 65535]), or "-" for one that is to be dropped. Fails
/// naming file and line.
Result<ClassTable> LoadClassTable(const std::string& path);

}  // namespace vismap
