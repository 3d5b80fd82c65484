; BROKEN     Twin of 14a_table_2_never_stops.smt2: stopping before an obstacle costs nothing, as S2's text has it.
(set-info :status sat)
(set-logic QF_NRA)

; Symbols
(declare-const p1 Real)       ; probability of an obstacle
(declare-const p2 Real)       ; probability of none
(declare-const stop1 Real)    ; loss of stopping before an obstacle
; Formulas
(define-fun maneuver () Real (+ (* 0 p1) (* 5 p2)))
(define-fun stop () Real (+ (* stop1 p1) (* 10 p2)))

; Assumptions
(assert (>= p1 0))
(assert (>= p2 0))
(assert (= (+ p1 p2) 1))
(assert (= stop1 0))                                           ; BROKEN: of the text

; Conclusion, negated
(assert (not (= (- stop maneuver) 5)))
(check-sat)
