// octopair: finds every colliding pair among millions of moving 3D objects. Includes all headers of octopair::octopair.
#pragma once

#include "octopair/box_array.hpp"
#include "octopair/engine.hpp"
#include "octopair/error.hpp"
#include "octopair/input.hpp"
#include "octopair/job.hpp"
#include "octopair/objects.hpp"
#include "octopair/octal_code.hpp"
#include "octopair/options.hpp"
#include "octopair/pair_list.hpp"
#include "octopair/pose.hpp"
#include "octopair/scene.hpp"
#include "octopair/summary.hpp"
#include "octopair/version.hpp"
