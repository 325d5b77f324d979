/* A first-order low-pass filter as a component in plain C.
 *
 * Property `share`: the share of the new value, from 0 to 1 (default 1).
 *
 * The tests build variants of it: SAMPLE_NAME is the type's name, PADDED makes the datum larger
 * than the type that its neighbours know by the same name.
 */
#include <component.h>

#include <stdio.h>
#include <stdlib.h>

#ifndef SAMPLE_NAME
#define SAMPLE_NAME "Sample"
#endif

struct sample {
    uint64_t number;
    double value;
#ifdef PADDED
    double padding;
#endif
};

struct low_pass {
    const steadfast_host_table *host;
    steadfast_host_context *context;
    double share;
    double state;
};

enum { RAW, SMOOTH };

static const steadfast_field fields[] = {
    STEADFAST_FIELD(struct sample, number, U64, ""),
    STEADFAST_FIELD(struct sample, value, F64, "m"),
};
static const steadfast_type sample = STEADFAST_TYPE(SAMPLE_NAME, struct sample, fields);
static const steadfast_port ports[] = {
    [RAW] = STEADFAST_DATA_INPUT("raw", &sample),
    [SMOOTH] = STEADFAST_DATA_OUTPUT("smooth", &sample),
};

static void say(const struct low_pass *filter, const char *text) {
    filter->host->log(filter->context, STEADFAST_LOG_INFORMATION, steadfast_text_of(text));
}

static steadfast_instance *create(const steadfast_host_table *host,
                                  steadfast_host_context *context) {
    struct low_pass *filter = calloc(1, sizeof *filter);
    if (filter) {
        filter->host = host;
        filter->context = context;
        filter->share = 1.0;
    }
    return (steadfast_instance *)filter;
}

static void destroy(steadfast_instance *instance) { free(instance); }

static steadfast_status on_initialize(steadfast_instance *instance) {
    struct low_pass *filter = (struct low_pass *)instance;
    uint8_t text[32] = {0};
    size_t length = 0;
    steadfast_status status = filter->host->property(
        filter->context, steadfast_text_of("share"), text, sizeof text - 1, &length);
    if (status == STEADFAST_SUCCESS)
        filter->share = strtod((const char *)text, NULL);
    if (filter->share <= 0.0 || filter->share > 1.0) {
        filter->host->failed(filter->context, steadfast_text_of("share must be above 0, at most 1"),
                             steadfast_text_of(""), 0, 0);
        return STEADFAST_INPUT_OUT_OF_RANGE;
    }
    return STEADFAST_SUCCESS;
}

/* What the container answers to a component that mistakes the size of its data. */
static steadfast_status on_start(steadfast_instance *instance) {
    struct low_pass *filter = (struct low_pass *)instance;
    struct sample datum = {0};
    char text[64];
    snprintf(text, sizeof text, "sizes: read %u, write %u, unknown port %u",
             filter->host->read(filter->context, RAW, (uint8_t *)&datum, sizeof datum - 1),
             filter->host->write(filter->context, SMOOTH, (const uint8_t *)&datum, 4),
             filter->host->read(filter->context, 7, (uint8_t *)&datum, sizeof datum));
    say(filter, text);
    return STEADFAST_SUCCESS;
}

static steadfast_status on_execute(steadfast_instance *instance) {
    struct low_pass *filter = (struct low_pass *)instance;
    struct sample datum = {0};
    while (filter->host->read(filter->context, RAW, (uint8_t *)&datum, sizeof datum) ==
           STEADFAST_SUCCESS) {
        filter->state += filter->share * (datum.value - filter->state);
        datum.value = filter->state;
        filter->host->write(filter->context, SMOOTH, (const uint8_t *)&datum, sizeof datum);
    }
    return STEADFAST_SUCCESS;
}

static steadfast_status on_stop(steadfast_instance *instance) {
    say((const struct low_pass *)instance, "stopped");
    return STEADFAST_SUCCESS;
}

STEADFAST_COMPONENT("low-pass", "1.0", ports, .create = create, .destroy_instance = destroy,
                    .on_initialize = on_initialize, .on_start = on_start,
                    .on_execute = on_execute, .on_stop = on_stop)
