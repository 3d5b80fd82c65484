; BROKEN     Twin of 14c_monotone_in_the_ratio.smt2: the second observation is more likely in the other state.
(set-info :status sat)
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
(assert (>= m1 m))                                             ; BROKEN: turned round
(assert (= (* after (+ (* l p) (* m (- 1 p)))) (* l p)))
(assert (= (* after1 (+ (* l1 p) (* m1 (- 1 p)))) (* l1 p)))

; Conclusion, negated
(assert (not (>= after1 after)))
(check-sat)
