// Jobs.
#include "octopair/job.hpp"

#include "call.hpp"
#include "engine_handle.hpp"

struct octopair_job {
    octopair::Job job;
};

namespace {

octopair::JobInput job_input_of(const octopair::Input& input) {
    if (input.second) return octopair::JobJoin{octopair::borrowed(input.first), octopair::borrowed(*input.second)};
    return octopair::JobObjects(octopair::borrowed(input.first));
}

}  // namespace

using octopair::c::guarded;
using octopair::c::required;

octopair_status octopair_job_submit(octopair_engine* engine, const octopair_objects* first,
                                    const octopair_objects* second, const octopair_options* options,
                                    octopair_job** job) {
    return guarded([&] {
        auto call = octopair::c::options_of(options);
        octopair_job*& out = required(job, "job");
        out = new octopair_job{
            required(engine, "engine")
                .engine->submit(job_input_of(octopair::c::input_of(first, second)), std::move(call.options))};
    });
}

octopair_job_state octopair_job_get_state(const octopair_job* job) {
    return job == nullptr ? OCTOPAIR_JOB_ENDED_BY_CANCEL : octopair_job_state(job->job.state());
}
double octopair_job_get_progress(const octopair_job* job) { return job == nullptr ? 0 : job->job.progress(); }

octopair_status octopair_job_wait(octopair_job* job, double seconds, int* ended) {
    return guarded([&] {
        const octopair::Job& waited = required(job, "job").job;
        int& out = required(ended, "ended");
        if (seconds < 0) {
            waited.wait();
            out = 1;
        } else {
            out = waited.wait_for(std::chrono::duration<double>(seconds)) ? 1 : 0;
        }
    });
}

void octopair_job_cancel(octopair_job* job) {
    if (job != nullptr) job->job.cancel();
}

octopair_status octopair_job_take_pairs(octopair_job* job, octopair_pairs* pairs, octopair_summary* summary) {
    return guarded([&] {
        octopair::Job& ended = required(job, "job").job;
        auto& list = required(pairs, "pairs").list;
        octopair::c::check_output(summary, "summary");
        const octopair::Summary found = ended.summary();
        list = ended.take_pairs();
        octopair::c::write_struct(summary, octopair::c::summary_of(found));
    });
}

void octopair_job_destroy(octopair_job* job) { delete job; }
