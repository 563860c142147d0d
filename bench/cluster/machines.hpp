// The paper's cluster, measured again: tables 1 and 2 and the component times with several processors on each machine.
// Covers the paper's algorithm and octopair's.
//
// Computing is measured on one machine, for each rank of many. The network time is a model:
// - Every machine has one port, with a bandwidth in each direction.
// - Each message adds a latency. Messages of one rank follow each other.
// - Network transfers do not overlap with computing.
// - Ranks of one machine do not use the network.
// - A rank that waits adds no time beyond the computing of other ranks.
//
// Source: Lucchesi, Egbert, Harris 2014, section 5.
#pragma once

#include <string>
#include <vector>

#include "cluster/measured.hpp"

namespace octopair::cluster {

/// The paper's network: "upward of eight times faster than a 100baseT Ethernet". The paper calls its latency low.
struct Network {
    double latency_seconds = 10e-6;
    double bytes_per_second = 100e6;
};

/// Seconds of a call.
struct Modelled {
    double computing = 0;  ///< measured by critical_path()
    double network = 0;    ///< computed by the model
    double all() const { return computing + network; }
};
Modelled modelled(const Measured& measured, const Network& network);

/// Returns the seconds of computing from the beginning to the end of a call. If ranks share every step: the seconds of
/// the slowest rank. In the paper's algorithm, each step begins after the step before, and takes the time of its
/// slowest rank. The master merges after the machines.
double critical_path(const Measured& measured);
/// Returns the seconds of merging in the paper's algorithm: at the master, or on the slowest of the other machines.
double merged_at_master(const EachRank& ranks);
double merged_on_machines(const EachRank& ranks);

/// Returns tables for people, or one JSON object for programs, ended by a newline. Efficiency needs the scene on one
/// rank in `all`.
std::string machines_text(const std::vector<Measured>& all, const Network& network);
std::string machines_json(const std::vector<Measured>& all, const Network& network);

}  // namespace octopair::cluster
