// The paper's cluster again: tables 1 and 2 and the component times with several processors on each machine, for the paper's
// arrangement of ranks and for octopair's.
//
// One machine measures what each rank of many computes. What a network would add is a model: every machine has one port, of
// a bandwidth in each direction; a message takes a latency beside; messages of one rank follow each other, and what goes over
// the network does not overlap with computing. Ranks of one machine do not need it. Waiting is what others compute.
//
// Source: Lucchesi, Egbert, Harris 2014, section 5.
#pragma once

#include <string>
#include <vector>

#include "cluster/measured.hpp"

namespace octopair::cluster {

/// The paper's: "upward of eight times faster than a 100baseT Ethernet". Of its latency it says that it is low.
struct Network {
    double latency_seconds = 10e-6;
    double bytes_per_second = 100e6;
};

/// The seconds of a call.
struct Modelled {
    double computing = 0;  ///< measured: critical_path()
    double network = 0;    ///< the model
    double all() const { return computing + network; }
};
Modelled modelled(const Measured& measured, const Network& network);

/// Seconds of computing from the begin to the end of a call. Where ranks share every step: of the slowest. In the paper's
/// arrangement steps wait for each other: each takes as long as on its slowest rank, and the master merges when the machines
/// have.
double critical_path(const Measured& measured);
/// Of the paper's arrangement: lists merged at the master, and on the slowest of the other machines.
double merged_at_master(const EachRank& ranks);
double merged_on_machines(const EachRank& ranks);

/// Tables for people; one JSON object for programs, ended by a newline. Setups that are to have an efficiency need their
/// scene on one rank among `all`.
std::string machines_text(const std::vector<Measured>& all, const Network& network);
std::string machines_json(const std::vector<Measured>& all, const Network& network);

}  // namespace octopair::cluster
