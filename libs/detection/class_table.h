#pragma once

#include <string>
#include <vector>

#include "base/ids.h"
#include "base/result.h"

namespace vismap {

/// The class of each output of a network, indexed by the network's class numbers from 0. Detections
/// of a class that is kUnknown are dropped.
using ClassTable = std::vector<ClassId>;

/// The 80 classes that COCO annotates, in the order of their ids. YOLO models are trained on them.
ClassTable Coco80();

/// All ids 1..90 of COCO, including those without annotations. TensorFlow's models count like this.
ClassTable Coco90();

/// Reads a text file with one line per class of the network, in the network's order: a COCO name
/// ("chair"), "ID NAME" for any other class (ID in [1, 65535]), or "-" for a class to drop. Fails,
/// naming file and line, if a line is malformed.
Result<ClassTable> LoadClassTable(const std::string& path);

}  // namespace vismap
