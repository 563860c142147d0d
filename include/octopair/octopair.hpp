// octopair: finds every colliding pair among millions of moving 3D objects.
//
// Includes all headers of the core, octopair::octopair: searches, jobs, lists of pairs, scenes and their queries.
// Headers of the other components are included by their names. Each needs its library (README.md, "Ten lines of C++"):
//
//     octopair::pipeline     filters.hpp, pipeline.hpp, shapes.hpp, collision.hpp
//     octopair::processes    processes.hpp
//     octopair::client       client.hpp, job_client.hpp, remote_scene.hpp, scene_watcher.hpp
//     octopair::mpi          mpi.hpp
#pragma once

#include "octopair/box_array.hpp"
#include "octopair/engine.hpp"
#include "octopair/error.hpp"
#include "octopair/input.hpp"
#include "octopair/job.hpp"
#include "octopair/limits.hpp"
#include "octopair/objects.hpp"
#include "octopair/octal_code.hpp"
#include "octopair/octants.hpp"
#include "octopair/options.hpp"
#include "octopair/pair_list.hpp"
#include "octopair/pose.hpp"
#include "octopair/scene.hpp"
#include "octopair/spheres.hpp"
#include "octopair/summary.hpp"
#include "octopair/version.hpp"
