; BROKEN     Twin of 14d_choice_is_invariant.smt2: the loss is added to one action only.
(set-info :status sat)
(set-logic QF_NRA)

; Symbols
(declare-const p1 Real)       ; probabilities
(declare-const p2 Real)
(declare-const a1 Real)       ; losses of one action
(declare-const a2 Real)
(declare-const b1 Real)       ; losses of the other
(declare-const b2 Real)
(declare-const k Real)        ; unit
(declare-const c1 Real)       ; what the states cost anyway
(declare-const c2 Real)
(declare-const d1 Real)       ; the same, for the other action
; Formulas
(define-fun before () Real (- (+ (* a1 p1) (* a2 p2)) (+ (* b1 p1) (* b2 p2))))
(define-fun after () Real
  (- (+ (* (+ (* k a1) c1) p1) (* (+ (* k a2) c2) p2))
     (+ (* (+ (* k b1) d1) p1) (* (+ (* k b2) c2) p2))))

; Assumptions
(assert (>= p1 0))
(assert (>= p2 0))
(assert (= (+ p1 p2) 1))
(assert (> k 0))
(assert (= d1 0))                                              ; BROKEN: one only

; Conclusion, negated
(assert (not (= (>= before 0) (>= after 0))))
(check-sat)
