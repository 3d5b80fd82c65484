; THEOREM    14c: the more an observation favours a state, the more probable that is afterwards.
; ASSUMED    A belief in two states, p and 1 - p; two observations, of which the second is no less likely
;            in the first state and no more likely in the other.
; CONCLUDED  The first state is no less probable after the second observation.
; SOURCE     S2 E21; spec/decide.md decide.INV-5.
; TWIN       the second observation is more likely in the other state.
; SOLVERS    z3
(set-info :status unsat)
(set-logic QF_NRA)

; Symbols
(declare-const p Real)        ; prior of the state
(declare-const l Real)        ; likelihood of the first observation in it
(declare-const m Real)        ; and in the other
(declare-const l1 Real)       ; likelihood of the second observation
(declare-const m1 Real)       ; and in the other
(declare-const after Real)    ; posterior after the first
(declare-const after1 Real)   ; posterior after the second

; Assumptions
(assert (< 0 p 1))
(assert (> l 0))
(assert (> m 0))
(assert (>= l1 l))
(assert (> m1 0))
(assert (<= m1 m))
(assert (= (* after (+ (* l p) (* m (- 1 p)))) (* l p)))
(assert (= (* after1 (+ (* l1 p) (* m1 (- 1 p)))) (* l1 p)))

; Conclusion, negated
(assert (not (>= after1 after)))
(check-sat)
