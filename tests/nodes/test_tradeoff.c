/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/programs/tradeoff.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* The search of `sortlast tradeoff` on made-up scenes whose costs follow its predictions exactly:
 * it then has to find the best of all combinations without trying them all. */

static void add_calls(struct tradeoff_study *study, const char *json) {
    cJSON *calls = cJSON_Parse(json);
    assert_non_null(calls);
    tradeoff_add_call_knobs(study, calls);
    cJSON_Delete(calls);
}

#define CALL(shader, function, line, column, issued)                                               \
    "{\"shader\":\"" shader "\",\"function\":\"" function "\",\"line\":" #line                     \
    ",\"column\":" #column ",\"issued\":" #issued "}"

static void knobs_are_for_calls_that_cost(void **state) {
    static const struct {
        const char *key, *calls;
    } expected[] = {
        {"math.a", "a:1:2,a:3:4,a:g.h:1:2"},
        {"math.b", "b:5:6"},
        {"math.a.1:2", "a:1:2"},
        {"math.a.3:4", "a:3:4"},
        {"math.a.g.h:1:2", "a:g.h:1:2"},
    };
    struct tradeoff_study study = {.knob_count = 0};
    add_calls(&study,
              "[" CALL("a", "sin", 1, 2, 1) "," CALL("a", "cos", 1, 2, 1) "," CALL(
                  "a", "pow", 3, 4,
                  2) "," CALL("u", "sin", 1, 1,
                              0) "," CALL("b", "exp", 5, 6,
                                          1) "," CALL("b", "exp", 7, 6,
                                                      0) ","
                                                         "{\"shader\":\"a\",\"function\":\"sin\","
                                                         "\"file\":\"g.h\",\"line\":1,"
                                                         "\"column\":2,\"issued\":1}]");
    assert_int_equal(study.knob_count, sizeof expected / sizeof *expected);
    for (int k = 0; k < study.knob_count; k++) {
        assert_string_equal(study.knobs[k].key, expected[k].key);
        assert_string_equal(study.knobs[k].calls, expected[k].calls);
        assert_int_equal(study.knobs[k].shader, k < 2 ? -1 : 0);
    }
    struct tradeoff_setting setting = {.choice = {0, 1, 1, 0, 1}};
    int count;
    char *text, **arguments = tradeoff_arguments(&study, &setting, &count, &text);
    assert_int_equal(count, 2);
    assert_string_equal(arguments[0], "--fast-calls");
    assert_string_equal(arguments[1], "b:5:6,a:1:2,a:g.h:1:2");
    free(arguments);
    free(text);
    tradeoff_finish_knobs(&study);
}

static void too_many_places_leave_the_knob_of_the_shader(void **state) {
    struct tradeoff_study study = {.knob_count = 0};
    cJSON *calls = cJSON_CreateArray();
    for (int i = 0; i < TRADEOFF_KNOBS_MAX + 8; i++) {
        cJSON *call = cJSON_Parse(i < 2 ? CALL("b", "sin", 1, 1, 1) : CALL("a", "sin", 1, 1, 1));
        cJSON_SetIntValue(cJSON_GetObjectItem(call, "line"), i + 1);
        cJSON_AddItemToArray(calls, call);
    }
    tradeoff_add_call_knobs(&study, calls);
    cJSON_Delete(calls);
    assert_int_equal(study.knob_count, 4); /* b, a, and the two places of b */
    assert_string_equal(study.knobs[1].key, "math.a");
    assert_string_equal(study.knobs[3].key, "math.b.2:1");
    tradeoff_finish_knobs(&study);
}

static void regions_are_assigned_where_there_are_several_nodes(void **state) {
    for (int several = 0; several < 2; several++) {
        struct tradeoff_study study = {.knob_count = 0};
        tradeoff_add_table_knobs(&study, several);
        assert_int_equal(tradeoff_find_knob(&study, "assignment") >= 0, several);
        assert_true(tradeoff_find_knob(&study, "samples") >= 0);
        tradeoff_finish_knobs(&study);
    }
}

/* Factor of time and square error of the values of each knob. */
struct model {
    double time[TRADEOFF_KNOBS_MAX][TRADEOFF_VALUES_MAX],
        error[TRADEOFF_KNOBS_MAX][TRADEOFF_VALUES_MAX];
};

static struct tradeoff_result run(const struct tradeoff_study *study, const struct model *model,
                                  const struct tradeoff_setting *setting) {
    struct tradeoff_result result = {.setting = *setting};
    double time = 1e12, error = 1e-6;
    for (int k = 0; k < study->knob_count; k++) {
        time *= setting->choice[k] ? model->time[k][setting->choice[k]] : 1;
        error += setting->choice[k] ? model->error[k][setting->choice[k]] : 0;
    }
    result.time_ps = result.shading_ps = (int64_t)time;
    result.error.square_error = error;
    return result;
}

static size_t search(struct tradeoff_study *study, const struct model *model, size_t most) {
    struct tradeoff_setting setting;
    size_t left;
    while (study->result_count < most && tradeoff_next(study, &setting, &left)) {
        study->results = memory_grow(study->results, &study->result_capacity,
                                     study->result_count + 1, sizeof *study->results);
        study->results[study->result_count++] = run(study, model, &setting);
    }
    return study->result_count;
}

/* The least time within the error, of all combinations that do not say one thing twice. */
static int64_t best_of_all(const struct tradeoff_study *study, const struct model *model,
                           double limit) {
    struct tradeoff_setting setting = {{0}};
    int64_t best = INT64_MAX;
    for (int k = 0; k < study->knob_count;) {
        bool is_twice = false;
        for (int i = 0; i < study->knob_count; i++)
            is_twice |= study->knobs[i].shader >= 0 && setting.choice[i] &&
                        setting.choice[study->knobs[i].shader];
        const struct tradeoff_result result = run(study, model, &setting);
        if (!is_twice && result.error.square_error <= limit && result.time_ps < best)
            best = result.time_ps;
        for (k = 0; k < study->knob_count; k++) {
            if (++setting.choice[k] < study->knobs[k].value_count)
                break;
            setting.choice[k] = 0;
        }
    }
    return best;
}

static int64_t best_found(const struct tradeoff_study *study, double limit) {
    int64_t best = INT64_MAX;
    for (size_t i = 0; i < study->result_count; i++)
        if (study->results[i].error.square_error <= limit && study->results[i].time_ps < best)
            best = study->results[i].time_ps;
    return best;
}

/* Knobs: samples, chord, parameters, a, b, a's places, b's places. All of a's functions are too
 * bad, one of its calls is good; b is harmless. */
static void calls_are_looked_at_where_their_shader_is_not_harmless(void **state) {
    enum { SAMPLES, CHORD, PARAMETERS, A, B, A1, A2, B1, B2 };
    struct tradeoff_study study = {.knob_count = 0};
    const struct model model = {.time = {[SAMPLES] = {1, 0.3, 0.1},
                                         [CHORD] = {1, 1, 1},
                                         [PARAMETERS] = {1, 1, 1, 1},
                                         [A] = {1, 0.81},
                                         [B] = {1, 0.9},
                                         [A1] = {1, 0.9},
                                         [A2] = {1, 0.9},
                                         [B1] = {1, 0.95},
                                         [B2] = {1, 0.95}},
                                .error = {[SAMPLES] = {0, 4e-6, 3e-5},
                                          [CHORD] = {0, 1e-6, 1e-5},
                                          [PARAMETERS] = {0, 1e-7, 5e-8, 2e-7},
                                          [A] = {0, 1.02e-5},
                                          [B] = {0, 1e-10},
                                          [A1] = {0, 2e-7},
                                          [A2] = {0, 1e-5},
                                          [B1] = {0, 5e-11},
                                          [B2] = {0, 5e-11}}};
    tradeoff_add_table_knobs(&study, false);
    add_calls(&study, "[" CALL("a", "sin", 1, 1, 1) "," CALL("a", "pow", 2, 1, 1) "," CALL(
                          "b", "sin", 1, 1, 1) "," CALL("b", "pow", 2, 1, 1) "]");
    assert_int_equal(study.knob_count, 9);
    const size_t runs = search(&study, &model, 1000);
    assert_in_range(runs, 12, 62); /* of 1728 */
    bool has_all_of_a = false;
    for (size_t i = 0; i < runs; i++) {
        const int *choice = study.results[i].setting.choice;
        assert_false(choice[B1] || choice[B2]);
        assert_false(choice[A] && (choice[A1] || choice[A2]));
        assert_false(choice[CHORD] && choice[SAMPLES]); /* which gains nothing */
        assert_true(has_all_of_a || !(choice[A1] || choice[A2]));
        has_all_of_a |= choice[A];
    }
    /* but for single calls of b, which are worth 5 % */
    for (double limit = 1e-6; limit < 1e-4; limit *= 1.1)
        assert_true(best_found(&study, limit) <= best_of_all(&study, &model, limit) * 20 / 19);
    /* within an error that all of a exceeds, one call of it is better than none */
    const double limit = 1.3e-6;
    assert_true(best_found(&study, limit) == (int64_t)(1e12 * 0.9 * 0.9));
    free(study.results);
    tradeoff_finish_knobs(&study);
}

static void many_knobs_end_all_the_same(void **state) {
    struct tradeoff_study study = {.knob_count = 0};
    struct model model = {0};
    tradeoff_add_table_knobs(&study, false);
    cJSON *calls = cJSON_CreateArray();
    for (int i = 0; i < 40; i++) {
        char name[8];
        cJSON *call = cJSON_Parse(CALL("x", "sin", 1, 1, 1));
        snprintf(name, sizeof name, "s%d", i);
        cJSON_ReplaceItemInObject(call, "shader", cJSON_CreateString(name));
        cJSON_AddItemToArray(calls, call);
    }
    tradeoff_add_call_knobs(&study, calls);
    cJSON_Delete(calls);
    for (int k = 0; k < study.knob_count; k++)
        for (int v = 1; v < TRADEOFF_VALUES_MAX; v++) {
            model.time[k][v] = 1 - 0.001 * (k + v);
            model.error[k][v] = 1e-7 * (k + v);
        }
    assert_int_equal(search(&study, &model, 56), 56);
    struct tradeoff_result *most = &study.results[55];
    int changed = 0;
    for (int k = 0; k < study.knob_count; k++)
        changed += most->setting.choice[k] != 0;
    assert_true(changed > 1);
    free(study.results);
    tradeoff_finish_knobs(&study);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(knobs_are_for_calls_that_cost),
        cmocka_unit_test(too_many_places_leave_the_knob_of_the_shader),
        cmocka_unit_test(regions_are_assigned_where_there_are_several_nodes),
        cmocka_unit_test(calls_are_looked_at_where_their_shader_is_not_harmless),
        cmocka_unit_test(many_knobs_end_all_the_same),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
